#include "pipelines.h"

#include "shared.h"

#include <cstdint>
#include <optional>
#include <span>

// The headers that glslangValidator writes define an array each.
#include "background_frag.h"
#include "background_vert.h"
#include "depth_masked_frag.h"
#include "depth_masked_vert.h"
#include "depth_vert.h"
#include "surface_frag.h"
#include "surface_masked_frag.h"
#include "surface_vert.h"
#include "wire_frag.h"
#include "wire_vert.h"

namespace xgc::vulkan {
namespace {

/// A shader module for as long as its pipeline is being made.
class Module {
public:
    Module(const Context& context, std::span<const uint32_t> words) : context_(context) {
        VkShaderModuleCreateInfo info{};
        info.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO;
        info.codeSize = words.size_bytes();
        info.pCode = words.data();
        result_ = context.vk().vkCreateShaderModule(context.device(), &info, context.allocation(), &module_);
    }
    Module(const Module&) = delete;
    Module& operator=(const Module&) = delete;
    ~Module() {
        if (module_) context_.vk().vkDestroyShaderModule(context_.device(), module_, context_.allocation());
    }
    VkPipelineShaderStageCreateInfo stage(VkShaderStageFlagBits which) const {
        VkPipelineShaderStageCreateInfo info{};
        info.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
        info.stage = which;
        info.module = module_;
        info.pName = "main";
        return info;
    }
    VkResult result() const { return result_; }

private:
    const Context& context_;
    VkShaderModule module_ = VK_NULL_HANDLE;
    VkResult result_ = VK_SUCCESS;
};

struct PipelineDesc {
    std::span<const uint32_t> vertex;
    std::span<const uint32_t> fragment; ///< may be none
    bool writesDepth;
    bool writesColor;
    bool posable = false;
};

VkPipelineDepthStencilStateCreateInfo depthState(const PipelineFormats& formats, bool used) {
    VkPipelineDepthStencilStateCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO;
    info.depthTestEnable = used;
    info.depthWriteEnable = used;
    info.depthCompareOp = formats.depthCompare;
    return info;
}

VkResult makePipeline(const Context& context, VkPipelineLayout layout, const PipelineFormats& formats,
                      const PipelineDesc& desc, VkPipeline& out) {
    const Module vertex(context, desc.vertex);
    if (vertex.result() != VK_SUCCESS) return vertex.result();
    std::optional<Module> fragment;
    if (!desc.fragment.empty()) fragment.emplace(context, desc.fragment);
    if (fragment && fragment->result() != VK_SUCCESS) return fragment->result();
    VkPipelineShaderStageCreateInfo stages[] = {vertex.stage(VK_SHADER_STAGE_VERTEX_BIT), {}};
    const VkBool32 posable = desc.posable;
    const VkSpecializationMapEntry constant{0, 0, sizeof posable};
    const VkSpecializationInfo constants{1, &constant, sizeof posable, &posable};
    stages[0].pSpecializationInfo = &constants;
    if (fragment) stages[1] = fragment->stage(VK_SHADER_STAGE_FRAGMENT_BIT);
    VkPipelineVertexInputStateCreateInfo input{};
    input.sType = VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO;
    VkPipelineInputAssemblyStateCreateInfo assembly{};
    assembly.sType = VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO;
    assembly.topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;
    VkPipelineViewportStateCreateInfo viewport{};
    viewport.sType = VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO;
    viewport.viewportCount = 1;
    viewport.scissorCount = 1;
    VkPipelineRasterizationStateCreateInfo raster{};
    raster.sType = VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO;
    raster.cullMode = VK_CULL_MODE_NONE; // open and inconsistently wound meshes show both sides
    raster.lineWidth = 1;
    raster.depthBiasEnable = !desc.writesColor;
    VkPipelineMultisampleStateCreateInfo multisample{};
    multisample.sType = VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO;
    multisample.rasterizationSamples = desc.writesColor ? formats.samples : formats.depthOnlySamples;
    const VkPipelineDepthStencilStateCreateInfo depth = depthState(formats, desc.writesDepth);
    VkPipelineColorBlendAttachmentState target{};
    target.colorWriteMask =
        VK_COLOR_COMPONENT_R_BIT | VK_COLOR_COMPONENT_G_BIT | VK_COLOR_COMPONENT_B_BIT | VK_COLOR_COMPONENT_A_BIT;
    VkPipelineColorBlendStateCreateInfo blend{};
    blend.sType = VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO;
    blend.attachmentCount = desc.writesColor ? 1 : 0;
    blend.pAttachments = &target;
    const VkDynamicState dynamics[] = {VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR,
                                       VK_DYNAMIC_STATE_DEPTH_BIAS};
    VkPipelineDynamicStateCreateInfo dynamic{};
    dynamic.sType = VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO;
    dynamic.dynamicStateCount = desc.writesColor ? 2 : 3;
    dynamic.pDynamicStates = dynamics;
    VkPipelineRenderingCreateInfo rendering{};
    rendering.sType = VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO;
    rendering.colorAttachmentCount = desc.writesColor ? 1 : 0;
    rendering.pColorAttachmentFormats = &formats.color;
    rendering.depthAttachmentFormat = formats.depth;

    VkGraphicsPipelineCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO;
    info.pNext = &rendering;
    info.stageCount = fragment ? 2 : 1;
    info.pStages = stages;
    info.pVertexInputState = &input;
    info.pInputAssemblyState = &assembly;
    info.pViewportState = &viewport;
    info.pRasterizationState = &raster;
    info.pMultisampleState = &multisample;
    info.pDepthStencilState = &depth;
    info.pColorBlendState = &blend;
    info.pDynamicState = &dynamic;
    info.layout = layout;
    return context.vk().vkCreateGraphicsPipelines(context.device(), VK_NULL_HANDLE, 1, &info, context.allocation(),
                                                  &out);
}

} // namespace

Status Pipelines::create(const Context& context, const PipelineFormats& formats) {
    context_ = &context;
    VkPushConstantRange range{};
    range.stageFlags = VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT;
    range.size = sizeof(shader::PushConstants);
    VkPipelineLayoutCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO;
    info.pushConstantRangeCount = 1;
    info.pPushConstantRanges = &range;
    VkResult result = context.vk().vkCreatePipelineLayout(context.device(), &info, context.allocation(), &layout_);
    const auto make = [&](const PipelineDesc& desc, VkPipeline& out) {
        if (result == VK_SUCCESS) result = makePipeline(context, layout_, formats, desc, out);
    };
    const auto makePair = [&](PipelineDesc desc, Pair& out) {
        for (const bool posable : {false, true}) {
            desc.posable = posable;
            make(desc, out[posable]);
        }
    };
    makePair({surface_vert, surface_frag, true, true}, surface_);
    makePair({surface_vert, surface_masked_frag, true, true}, surfaceMasked_);
    makePair({wire_vert, wire_frag, true, true}, wire_);
    make({background_vert, background_frag, false, true}, background_);
    makePair({depth_vert, {}, true, false}, depth_);
    makePair({depth_masked_vert, depth_masked_frag, true, false}, depthMasked_);
    return result == VK_SUCCESS ? Status{} : refused("a pipeline could not be made for these formats", result);
}

Pipelines::~Pipelines() {
    if (!context_) return;
    const Functions& vk = context_->vk();
    const auto destroy = [&](VkPipeline pipeline) {
        if (pipeline) vk.vkDestroyPipeline(context_->device(), pipeline, context_->allocation());
    };
    for (const Pair& pair : {surface_, surfaceMasked_, wire_, depth_, depthMasked_}) {
        for (const VkPipeline pipeline : pair) destroy(pipeline);
    }
    destroy(background_);
    if (layout_) vk.vkDestroyPipelineLayout(context_->device(), layout_, context_->allocation());
}

} // namespace xgc::vulkan
