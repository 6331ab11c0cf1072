#include "interface.h"

#include "theme.h"

#include <GLFW/glfw3.h>
#include <imgui.h>

#include <backends/imgui_impl_vulkan.h>

namespace xgc::viewer {
namespace {

/// ImGui's name for a key, by ours.
void mapKeys(ImGuiIO& io) {
    constexpr std::pair<ImGuiKey, int> kKeys[] = {{ImGuiKey_Tab, kKeyTab},
                                                  {ImGuiKey_LeftArrow, kKeyLeft},
                                                  {ImGuiKey_RightArrow, kKeyRight},
                                                  {ImGuiKey_UpArrow, kKeyUp},
                                                  {ImGuiKey_DownArrow, kKeyDown},
                                                  {ImGuiKey_Home, kKeyHome},
                                                  {ImGuiKey_End, kKeyEnd},
                                                  {ImGuiKey_Delete, kKeyDelete},
                                                  {ImGuiKey_Backspace, kKeyBackspace},
                                                  {ImGuiKey_Space, kKeySpace},
                                                  {ImGuiKey_Enter, kKeyEnter},
                                                  {ImGuiKey_Escape, kKeyEscape},
                                                  {ImGuiKey_A, 'A'},
                                                  {ImGuiKey_C, 'C'},
                                                  {ImGuiKey_V, 'V'},
                                                  {ImGuiKey_X, 'X'},
                                                  {ImGuiKey_Y, 'Y'},
                                                  {ImGuiKey_Z, 'Z'}};
    for (const auto& [name, key] : kKeys) io.KeyMap[name] = key;
}

void useClipboard(ImGuiIO& io, GLFWwindow* window) {
    io.ClipboardUserData = window;
    io.GetClipboardTextFn = [](void* user) { return glfwGetClipboardString(static_cast<GLFWwindow*>(user)); };
    io.SetClipboardTextFn = [](void* user, const char* text) {
        glfwSetClipboardString(static_cast<GLFWwindow*>(user), text);
    };
}

} // namespace

Interface::~Interface() {
    if (!device_) return;
    if (started_) ImGui_ImplVulkan_Shutdown();
    if (ImGui::GetCurrentContext()) ImGui::DestroyContext();
    if (framebuffer_) vkDestroyFramebuffer(device_->device(), framebuffer_, nullptr);
    if (pass_) vkDestroyRenderPass(device_->device(), pass_, nullptr);
    if (pool_) vkDestroyDescriptorPool(device_->device(), pool_, nullptr);
}

bake::Status Interface::create(const Device& device, GLFWwindow* window, uint32_t framesInFlight, float scale) {
    device_ = &device;
    ImGui::CreateContext();
    ImGuiIO& io = ImGui::GetIO();
    io.IniFilename = nullptr; // the viewer starts as it is described
    io.BackendPlatformName = "xgc-viewer";
    mapKeys(io);
    useClipboard(io, window);
    applyTheme(scale);
    const bake::Status status = createPass();
    if (!status.ok()) return status;

    const VkDescriptorPoolSize size{VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 4};
    VkDescriptorPoolCreateInfo pool{};
    pool.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO;
    pool.maxSets = 4;
    pool.poolSizeCount = 1;
    pool.pPoolSizes = &size;
    const VkResult result = vkCreateDescriptorPool(device.device(), &pool, nullptr, &pool_);
    if (result != VK_SUCCESS) return vulkanError("vkCreateDescriptorPool", result);

    ImGui_ImplVulkan_InitInfo info{};
    info.Instance = device.instance();
    info.PhysicalDevice = device.physical();
    info.Device = device.device();
    info.QueueFamily = device.queueFamily();
    info.Queue = device.queue();
    info.DescriptorPool = pool_;
    info.MinImageCount = info.ImageCount = framesInFlight; // how many sets of buffers it turns through
    info.MSAASamples = VK_SAMPLE_COUNT_1_BIT;
    started_ = ImGui_ImplVulkan_Init(&info, pass_);
    return started_ ? uploadFont() : bake::systemError("ImGui could not start");
}

/// Keeps what is there and draws over it.
bake::Status Interface::createPass() {
    VkAttachmentDescription color{};
    color.format = Canvas::kPanelFormat;
    color.samples = VK_SAMPLE_COUNT_1_BIT;
    color.loadOp = VK_ATTACHMENT_LOAD_OP_LOAD;
    color.storeOp = VK_ATTACHMENT_STORE_OP_STORE;
    color.stencilLoadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE;
    color.stencilStoreOp = VK_ATTACHMENT_STORE_OP_DONT_CARE;
    color.initialLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
    color.finalLayout = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL;
    const VkAttachmentReference reference{0, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL};
    VkSubpassDescription subpass{};
    subpass.pipelineBindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS;
    subpass.colorAttachmentCount = 1;
    subpass.pColorAttachments = &reference;
    VkSubpassDependency around[2]{};
    around[0].srcSubpass = VK_SUBPASS_EXTERNAL;
    around[0].srcStageMask = around[0].dstStageMask = VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT;
    around[0].srcAccessMask = VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT;
    around[0].dstAccessMask = VK_ACCESS_COLOR_ATTACHMENT_READ_BIT | VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT;
    around[1].dstSubpass = VK_SUBPASS_EXTERNAL;
    around[1].srcStageMask = VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT;
    around[1].srcAccessMask = VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT;
    around[1].dstStageMask = VK_PIPELINE_STAGE_TRANSFER_BIT;
    around[1].dstAccessMask = VK_ACCESS_TRANSFER_READ_BIT;
    VkRenderPassCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO;
    info.attachmentCount = 1;
    info.pAttachments = &color;
    info.subpassCount = 1;
    info.pSubpasses = &subpass;
    info.dependencyCount = 2;
    info.pDependencies = around;
    const VkResult result = vkCreateRenderPass(device_->device(), &info, nullptr, &pass_);
    return result == VK_SUCCESS ? bake::Status{} : vulkanError("vkCreateRenderPass", result);
}

bake::Status Interface::uploadFont() {
    VkCommandPoolCreateInfo poolInfo{};
    poolInfo.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO;
    poolInfo.queueFamilyIndex = device_->queueFamily();
    VkCommandPool pool = VK_NULL_HANDLE;
    VkResult result = vkCreateCommandPool(device_->device(), &poolInfo, nullptr, &pool);
    if (result != VK_SUCCESS) return vulkanError("vkCreateCommandPool", result);
    VkCommandBufferAllocateInfo allocate{};
    allocate.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO;
    allocate.commandPool = pool;
    allocate.commandBufferCount = 1;
    VkCommandBuffer cmd = VK_NULL_HANDLE;
    result = vkAllocateCommandBuffers(device_->device(), &allocate, &cmd);
    if (result == VK_SUCCESS) {
        VkCommandBufferBeginInfo begin{};
        begin.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO;
        vkBeginCommandBuffer(cmd, &begin);
        ImGui_ImplVulkan_CreateFontsTexture(cmd);
        vkEndCommandBuffer(cmd);
        VkSubmitInfo submit{};
        submit.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO;
        submit.commandBufferCount = 1;
        submit.pCommandBuffers = &cmd;
        result = vkQueueSubmit(device_->queue(), 1, &submit, VK_NULL_HANDLE);
        device_->waitIdle();
        ImGui_ImplVulkan_DestroyFontUploadObjects();
    }
    vkDestroyCommandPool(device_->device(), pool, nullptr);
    return result == VK_SUCCESS ? bake::Status{} : vulkanError("uploading the font", result);
}

bake::Status Interface::attach(const Canvas& canvas) {
    if (framebuffer_) vkDestroyFramebuffer(device_->device(), framebuffer_, nullptr);
    framebuffer_ = VK_NULL_HANDLE;
    const VkImageView view = canvas.panelView();
    VkFramebufferCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO;
    info.renderPass = pass_;
    info.attachmentCount = 1;
    info.pAttachments = &view;
    info.width = canvas.size().width;
    info.height = canvas.size().height;
    info.layers = 1;
    const VkResult result = vkCreateFramebuffer(device_->device(), &info, nullptr, &framebuffer_);
    return result == VK_SUCCESS ? bake::Status{} : vulkanError("vkCreateFramebuffer", result);
}

void Interface::feed(const Event& event) {
    ImGuiIO& io = ImGui::GetIO();
    switch (event.kind) {
    case EventKind::move:
        io.MousePos = {event.x, event.y};
        break;
    case EventKind::button:
        if (event.code < IM_ARRAYSIZE(io.MouseDown)) io.MouseDown[event.code] = event.down;
        break;
    case EventKind::wheel:
        io.MouseWheelH += event.x;
        io.MouseWheel += event.y;
        break;
    case EventKind::key:
        if (event.code < IM_ARRAYSIZE(io.KeysDown)) io.KeysDown[event.code] = event.down;
        io.KeyCtrl = io.KeysDown[kKeyLeftControl] || io.KeysDown[kKeyRightControl];
        io.KeyShift = io.KeysDown[kKeyLeftShift] || io.KeysDown[kKeyRightShift];
        io.KeyAlt = io.KeysDown[kKeyLeftAlt];
        break;
    case EventKind::text:
        io.AddInputCharacter(unsigned(event.code));
        break;
    case EventKind::drop:
    case EventKind::quit:
        break;
    }
}

bool Interface::wantsMouse() const {
    return ImGui::GetIO().WantCaptureMouse;
}

bool Interface::wantsKeys() const {
    return ImGui::GetIO().WantTextInput;
}

void Interface::begin(VkExtent2D size, float seconds) {
    ImGuiIO& io = ImGui::GetIO();
    io.DisplaySize = {float(size.width), float(size.height)};
    io.DeltaTime = seconds > 0 ? seconds : 1e-4f;
    ImGui_ImplVulkan_NewFrame();
    ImGui::NewFrame();
}

void Interface::end() {
    ImGui::Render();
}

void Interface::record(VkCommandBuffer cmd, const Canvas& canvas) const {
    VkRenderPassBeginInfo info{};
    info.sType = VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO;
    info.renderPass = pass_;
    info.framebuffer = framebuffer_;
    info.renderArea.extent = canvas.size();
    vkCmdBeginRenderPass(cmd, &info, VK_SUBPASS_CONTENTS_INLINE);
    ImGui_ImplVulkan_RenderDrawData(ImGui::GetDrawData(), cmd);
    vkCmdEndRenderPass(cmd);
}

} // namespace xgc::viewer
