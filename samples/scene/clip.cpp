#include "clip.h"

#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <stdexcept>

namespace xgc::scene_sample {

using Json = nlohmann::json;

/// The two chunks of a .glb. What is not as it should be throws; `Clip::read` catches.
class ClipReader {
public:
    explicit ClipReader(const std::filesystem::path& file) {
        std::ifstream stream(file, std::ios::binary);
        bytes_.assign(std::istreambuf_iterator<char>(stream), {});
        if (bytes_.size() < 20 || word(0) != 0x46546c67) throw std::runtime_error("not a .glb file");
        const size_t length = word(12);
        json_ = Json::parse(part(20, length));
        binary_ = 20 + length + 8;
    }

    void read(const std::string& name, Clip& out) const {
        const Json& animations = json_.at("animations");
        const Json* chosen = &animations.at(0);
        for (const Json& a : animations) {
            if (a.value("name", "") == name) chosen = &a;
        }
        for (const Json& channel : chosen->at("channels")) readChannel(channel, chosen->at("samplers"), out);
    }

private:
    uint32_t word(size_t at) const {
        uint32_t out = 0;
        std::memcpy(&out, part(at, sizeof out).data(), sizeof out);
        return out;
    }
    std::string_view part(size_t at, size_t size) const {
        if (at > bytes_.size() || size > bytes_.size() - at) throw std::runtime_error("the file ends too early");
        return std::string_view(bytes_).substr(at, size);
    }

    std::vector<glm::vec4> floats(size_t accessor, size_t components) const {
        const Json& a = json_.at("accessors").at(accessor);
        const Json& view = json_.at("bufferViews").at(a.at("bufferView").get<size_t>());
        if (a.at("componentType") != 5126) throw std::runtime_error("keys that are not floats");
        const size_t first = binary_ + view.value("byteOffset", size_t(0)) + a.value("byteOffset", size_t(0));
        const size_t stride = view.value("byteStride", 4 * components);
        std::vector<glm::vec4> out(std::min(a.at("count").get<size_t>(), bytes_.size()), glm::vec4(0));
        for (size_t i = 0; i < out.size(); ++i) {
            std::memcpy(&out[i], part(first + i * stride, 4 * components).data(), 4 * components);
        }
        return out;
    }

    Clip::Node& nodeOf(size_t number, Clip& out) const {
        const Json& source = json_.at("nodes").at(number);
        const std::string name = source.value("name", "");
        for (Clip::Node& node : out.nodes_) {
            if (node.name == name) return node;
        }
        Clip::Node& node = out.nodes_.emplace_back();
        node.name = name;
        const auto numbers = [&](const char* key, int count, auto& value) {
            if (!source.contains(key)) return;
            for (int k = 0; k < count; ++k) value[k] = source.at(key).at(size_t(k)).get<float>();
        };
        numbers("translation", 3, node.translation);
        numbers("rotation", 4, node.rotation);
        numbers("scale", 3, node.scale);
        return node;
    }

    void readChannel(const Json& channel, const Json& samplers, Clip& out) const {
        const Json& target = channel.at("target");
        const std::string path = target.at("path");
        if (!target.contains("node") || path == "weights") return;
        const Json& sampler = samplers.at(channel.at("sampler").get<size_t>());
        const std::string kind = sampler.value("interpolation", "LINEAR");
        if (kind == "CUBICSPLINE") throw std::runtime_error("cubic keys: export it with linear ones");
        Clip::Channel keys;
        keys.path = path == "translation" ? Clip::Path::translation
                    : path == "rotation"  ? Clip::Path::rotation
                                          : Clip::Path::scale;
        keys.step = kind == "STEP";
        for (const glm::vec4& t : floats(sampler.at("input").get<size_t>(), 1)) keys.times.push_back(t.x);
        keys.values = floats(sampler.at("output").get<size_t>(), path == "rotation" ? 4 : 3);
        if (keys.times.empty() || keys.values.size() != keys.times.size())
            throw std::runtime_error("a channel with other times than values");
        out.seconds_ = std::max(out.seconds_, keys.times.back());
        nodeOf(target.at("node").get<size_t>(), out).channels.push_back(std::move(keys));
    }

    std::string bytes_;
    Json json_;
    size_t binary_ = 0;
};

bake::Status Clip::read(const std::filesystem::path& glb, const std::string& name, Clip& out) {
    try {
        Clip clip;
        ClipReader(glb).read(name, clip);
        out = std::move(clip);
        return {};
    } catch (const std::exception& error) {
        return bake::badInput(fmt::format("{}: no animation: {}", glb.string(), error.what()));
    }
}

glm::vec4 Clip::Channel::at(float second) const {
    const auto after = size_t(std::upper_bound(times.begin(), times.end(), second) - times.begin());
    if (after == 0) return values.front();
    if (after == times.size() || step) return values[after - 1];
    const float part = (second - times[after - 1]) / (times[after] - times[after - 1]);
    glm::vec4 next = values[after];
    if (path == Path::rotation && glm::dot(values[after - 1], next) < 0) next = -next; // the short way round
    return glm::mix(values[after - 1], next, part);
}

void Clip::sample(const AssetView& asset, float second, std::span<glm::mat4> toParent) const {
    const auto toMesh = [&](uint32_t node) {
        glm::mat4 m;
        std::memcpy(&m, asset.nodes[node].toMesh, sizeof m);
        return m;
    };
    for (uint32_t i = 0; i < asset.nodes.size(); ++i) {
        const uint32_t parent = asset.nodes[i].parent;
        toParent[i] = parent == format::kNone ? toMesh(i) : glm::inverse(toMesh(parent)) * toMesh(i);
        const auto moved = std::find_if(nodes_.begin(), nodes_.end(),
                                        [&](const Node& n) { return n.name == asset.text(asset.nodes[i].name); });
        if (moved == nodes_.end()) continue;
        glm::vec3 translation = moved->translation, scale = moved->scale;
        glm::vec4 rotation = moved->rotation;
        for (const Channel& channel : moved->channels) {
            const glm::vec4 value = channel.at(second);
            if (channel.path == Path::translation) translation = glm::vec3(value);
            if (channel.path == Path::rotation) rotation = value;
            if (channel.path == Path::scale) scale = glm::vec3(value);
        }
        const glm::quat turn = glm::normalize(glm::quat(rotation.w, rotation.x, rotation.y, rotation.z));
        toParent[i] = glm::scale(glm::translate(glm::mat4(1), translation) * glm::mat4_cast(turn), scale);
    }
}

} // namespace xgc::scene_sample
