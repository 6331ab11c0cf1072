#include <xgc/vulkan/features.h>
#include <xgc/vulkan/headless_device.h>

#include <dlfcn.h>

#include <mutex>

namespace xgc::vulkan {
namespace {

struct MessageSink {
    mutable std::mutex mutex; ///< guards `messages`: any thread that calls Vulkan may add one
    std::vector<std::string> messages;
};

VkBool32 VKAPI_CALL keepMessage(VkDebugUtilsMessageSeverityFlagBitsEXT, VkDebugUtilsMessageTypeFlagsEXT,
                                const VkDebugUtilsMessengerCallbackDataEXT* data, void* user) {
    auto& sink = *static_cast<MessageSink*>(user);
    const std::lock_guard lock(sink.mutex);
    sink.messages.emplace_back(data->pMessage ? data->pMessage : "");
    return VK_FALSE;
}

/// Messages of the validation layer. The loader's remarks about drivers are not among them.
VkDebugUtilsMessengerCreateInfoEXT messengerInfo(MessageSink& sink) {
    VkDebugUtilsMessengerCreateInfoEXT info{};
    info.sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT;
    info.messageSeverity =
        VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
    info.messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_TYPE_PERFORMANCE_BIT_EXT;
    info.pfnUserCallback = keepMessage;
    info.pUserData = &sink;
    return info;
}

struct Candidate {
    VkPhysicalDevice device = VK_NULL_HANDLE;
    uint32_t queueFamily = 0;
    int rank = -1;
    std::string name;
};

int rankOf(VkPhysicalDeviceType type) {
    switch (type) {
    case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
        return 3;
    case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU:
        return 2;
    case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU:
        return 1;
    default:
        return 0;
    }
}

} // namespace

struct HeadlessDevice::Impl {
    void* library = nullptr;
    PFN_vkGetInstanceProcAddr getInstanceProcAddr = nullptr;
    const VkAllocationCallbacks* allocation = nullptr;
    VkInstance instance = VK_NULL_HANDLE;
    VkDebugUtilsMessengerEXT messenger = VK_NULL_HANDLE;
    Candidate chosen;
    bool drawIndirectCount = false;
    VkDevice device = VK_NULL_HANDLE;
    VkQueue queue = VK_NULL_HANDLE;
    MessageSink sink;

    ~Impl();
    Status loadLibrary();
    Status createInstance(bool collectMessages);
    Status createMessenger();
    Candidate inspect(VkPhysicalDevice physical) const;
    Status chooseDevice();
    Status createDevice();

    template <typename F>
    F function(const char* name) const {
        return reinterpret_cast<F>(getInstanceProcAddr(instance, name));
    }
};

HeadlessDevice::Impl::~Impl() {
    if (device) function<PFN_vkDestroyDevice>("vkDestroyDevice")(device, allocation);
    if (messenger) {
        function<PFN_vkDestroyDebugUtilsMessengerEXT>("vkDestroyDebugUtilsMessengerEXT")(instance, messenger,
                                                                                         allocation);
    }
    if (instance) function<PFN_vkDestroyInstance>("vkDestroyInstance")(instance, allocation);
    if (library) dlclose(library);
}

Status HeadlessDevice::Impl::loadLibrary() {
    for (const char* file : {"libvulkan.so.1", "libvulkan.so"}) {
        library = dlopen(file, RTLD_NOW | RTLD_LOCAL);
        if (library) break;
    }
    if (!library) return refused("no Vulkan loader (libvulkan.so.1): install one", VK_ERROR_INITIALIZATION_FAILED);
    getInstanceProcAddr = reinterpret_cast<PFN_vkGetInstanceProcAddr>(dlsym(library, "vkGetInstanceProcAddr"));
    if (!getInstanceProcAddr) {
        return refused("libvulkan.so.1 has no vkGetInstanceProcAddr", VK_ERROR_INITIALIZATION_FAILED);
    }
    return {};
}

Status HeadlessDevice::Impl::createInstance(bool collectMessages) {
    VkApplicationInfo app{};
    app.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO;
    app.pEngineName = "xgc";
    app.apiVersion = VK_API_VERSION_1_3;
    VkDebugUtilsMessengerCreateInfoEXT debug = messengerInfo(sink);
    const char* extension = VK_EXT_DEBUG_UTILS_EXTENSION_NAME;
    VkInstanceCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO;
    info.pApplicationInfo = &app;
    if (collectMessages) {
        info.pNext = &debug;
        info.enabledExtensionCount = 1;
        info.ppEnabledExtensionNames = &extension;
    }
    const VkResult result = function<PFN_vkCreateInstance>("vkCreateInstance")(&info, allocation, &instance);
    if (result != VK_SUCCESS) return refused("no Vulkan instance: is a driver installed?", result);
    if (!collectMessages) return {};
    const auto create = function<PFN_vkCreateDebugUtilsMessengerEXT>("vkCreateDebugUtilsMessengerEXT");
    const VkResult made = create(instance, &debug, allocation, &messenger);
    return made == VK_SUCCESS ? Status{} : refused("vkCreateDebugUtilsMessengerEXT failed", made);
}

/// The device with its first graphics queue; rank -1 where it will not do.
Candidate HeadlessDevice::Impl::inspect(VkPhysicalDevice physical) const {
    Candidate candidate;
    VkPhysicalDeviceProperties properties;
    function<PFN_vkGetPhysicalDeviceProperties>("vkGetPhysicalDeviceProperties")(physical, &properties);
    if (properties.apiVersion < VK_API_VERSION_1_3) return candidate;
    Features features;
    function<PFN_vkGetPhysicalDeviceFeatures2>("vkGetPhysicalDeviceFeatures2")(physical, features.chain());
    if (missingFeature(features)) return candidate;

    const auto getFamilies =
        function<PFN_vkGetPhysicalDeviceQueueFamilyProperties>("vkGetPhysicalDeviceQueueFamilyProperties");
    uint32_t count = 0;
    getFamilies(physical, &count, nullptr);
    std::vector<VkQueueFamilyProperties> families(count);
    getFamilies(physical, &count, families.data());
    for (uint32_t i = 0; i < count; ++i) {
        if (!(families[i].queueFlags & VK_QUEUE_GRAPHICS_BIT)) continue;
        return {physical, i, rankOf(properties.deviceType), properties.deviceName};
    }
    return candidate;
}

Status HeadlessDevice::Impl::chooseDevice() {
    const auto enumerate = function<PFN_vkEnumeratePhysicalDevices>("vkEnumeratePhysicalDevices");
    uint32_t count = 0;
    enumerate(instance, &count, nullptr);
    std::vector<VkPhysicalDevice> devices(count);
    const VkResult result = enumerate(instance, &count, devices.data());
    if (result != VK_SUCCESS && result != VK_INCOMPLETE) return refused("no Vulkan device was found", result);
    devices.resize(count);
    for (VkPhysicalDevice physical : devices) {
        const Candidate candidate = inspect(physical);
        if (candidate.rank > chosen.rank) chosen = candidate;
    }
    if (chosen.rank >= 0) return {};
    return refused("no Vulkan 1.3 device with the features that xgc needs: install a driver (Mesa's lavapipe will do)",
                   VK_ERROR_INCOMPATIBLE_DRIVER);
}

Status HeadlessDevice::Impl::createDevice() {
    Features features, have;
    requireFeatures(features);
    function<PFN_vkGetPhysicalDeviceFeatures2>("vkGetPhysicalDeviceFeatures2")(chosen.device, have.chain());
    features.vulkan12.drawIndirectCount = have.vulkan12.drawIndirectCount;
    drawIndirectCount = have.vulkan12.drawIndirectCount == VK_TRUE;
    const float priority = 1;
    VkDeviceQueueCreateInfo queueInfo{};
    queueInfo.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO;
    queueInfo.queueFamilyIndex = chosen.queueFamily;
    queueInfo.queueCount = 1;
    queueInfo.pQueuePriorities = &priority;
    VkDeviceCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO;
    info.pNext = features.chain();
    info.queueCreateInfoCount = 1;
    info.pQueueCreateInfos = &queueInfo;
    const VkResult result = function<PFN_vkCreateDevice>("vkCreateDevice")(chosen.device, &info, allocation, &device);
    if (result != VK_SUCCESS) return refused("vkCreateDevice failed", result);
    function<PFN_vkGetDeviceQueue>("vkGetDeviceQueue")(device, chosen.queueFamily, 0, &queue);
    return {};
}

HeadlessDevice::HeadlessDevice() = default;
HeadlessDevice::~HeadlessDevice() = default;
HeadlessDevice::HeadlessDevice(HeadlessDevice&&) noexcept = default;
HeadlessDevice& HeadlessDevice::operator=(HeadlessDevice&&) noexcept = default;

Status HeadlessDevice::create(const HeadlessDeviceDesc& desc) {
    auto impl = std::make_unique<Impl>();
    impl->allocation = desc.allocation;
    Status status = impl->loadLibrary();
    if (status.ok()) status = impl->createInstance(desc.collectMessages);
    if (status.ok()) status = impl->chooseDevice();
    if (status.ok()) status = impl->createDevice();
    if (status.ok()) impl_ = std::move(impl);
    return status;
}

ContextDesc HeadlessDevice::contextDesc() const {
    ContextDesc desc;
    desc.getInstanceProcAddr = impl_->getInstanceProcAddr;
    desc.instance = impl_->instance;
    desc.physicalDevice = impl_->chosen.device;
    desc.device = impl_->device;
    desc.queueFamily = impl_->chosen.queueFamily;
    desc.drawIndirectCount = impl_->drawIndirectCount;
    desc.allocation = impl_->allocation;
    return desc;
}

VkQueue HeadlessDevice::queue() const {
    return impl_->queue;
}

const char* HeadlessDevice::name() const {
    return impl_->chosen.name.c_str();
}

std::vector<std::string> HeadlessDevice::messages() const {
    const std::lock_guard lock(impl_->sink.mutex);
    return impl_->sink.messages;
}

} // namespace xgc::vulkan
