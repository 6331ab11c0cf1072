#include <import/gltf_document.h>

#include <import/input_file.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cstring>
#include <string_view>

namespace xgc::bake {

namespace {

using Json = nlohmann::json;

Status refuse(const Source& source, std::string_view what) {
    return badInput(fmt::format("{}: {}", source.name, what));
}

uint32_t readU32(std::span<const std::byte> bytes, size_t at) {
    uint32_t value = 0;
    for (size_t i = 0; i < 4; ++i) value |= uint32_t(bytes[at + i]) << (8 * i);
    return value;
}

struct Chunks {
    std::string_view json;
    std::span<const std::byte> binary;
    bool isGlb = false;
};

Status splitGlb(const Source& source, Chunks& out) {
    constexpr uint32_t kMagic = 0x46546c67, kJson = 0x4e4f534a, kBinary = 0x004e4942;
    const std::span<const std::byte> bytes = source.bytes;
    if (bytes.size() < 20 || readU32(bytes, 0) != kMagic)
        return refuse(source, "it is no GLB file: the magic \"glTF\" is missing; check the extension");
    if (readU32(bytes, 4) != 2)
        return refuse(source, fmt::format("GLB version {}; export it as version 2", readU32(bytes, 4)));
    const uint64_t length = readU32(bytes, 8);
    if (length > bytes.size())
        return refuse(source, fmt::format("truncated: {} of {} bytes; export it again", bytes.size(), length));
    out.isGlb = true;
    uint64_t at = 12;
    for (int chunk = 0; at + 8 <= length; ++chunk) {
        const uint64_t size = readU32(bytes, at), type = readU32(bytes, at + 4);
        if (size > length - at - 8)
            return refuse(source, fmt::format("chunk {} reaches past the end; export it again", chunk));
        const std::span<const std::byte> data = bytes.subspan(at + 8, size);
        if (chunk == 0 && type != kJson) return refuse(source, "its first chunk is not JSON; export it again");
        if (chunk == 0) out.json = {reinterpret_cast<const char*>(data.data()), data.size()};
        if (chunk == 1 && type == kBinary) out.binary = data;
        at += 8 + (size + 3) / 4 * 4;
    }
    return {};
}

/// tinygltf and JSON's copies recurse into values.
bool isTooDeep(std::string_view json) {
    constexpr int kDeepest = 128;
    int depth = 0;
    bool inString = false;
    for (size_t i = 0; i < json.size(); ++i) {
        const char c = json[i];
        if (inString) {
            i += c == '\\';
            inString = c != '"';
        } else if (c == '"') {
            inString = true;
        } else if (c == '{' || c == '[') {
            if (++depth > kDeepest) return true;
        } else {
            depth -= c == '}' || c == ']';
        }
    }
    return false;
}

Status checkExtensions(const Source& source, const Json& json) {
    constexpr std::array<std::string_view, 8> kHarmless = {
        "KHR_mesh_quantization", "KHR_texture_transform", "KHR_texture_basisu", "KHR_lights_punctual",
        "EXT_texture_webp",      "EXT_texture_avif",      "MSFT_texture_dds",   "KHR_xmp_json_ld"};
    const auto required = json.find("extensionsRequired");
    if (required == json.end() || !required->is_array()) return {};
    for (const Json& entry : *required) {
        const std::string name = entry.is_string() ? entry.get<std::string>() : entry.dump();
        if (name.starts_with("KHR_materials_") || std::ranges::find(kHarmless, name) != kHarmless.end()) continue;
        const bool packed = name == "KHR_draco_mesh_compression" || name == "EXT_meshopt_compression";
        return refuse(source, fmt::format("it requires the extension {}, which is not supported; {}", name,
                                          packed ? "export it without compression" : "export it without that"));
    }
    return {};
}

std::string decodePercent(std::string_view uri) {
    const auto digit = [](char c) {
        return c >= '0' && c <= '9'   ? c - '0'
               : c >= 'a' && c <= 'f' ? c - 'a' + 10
               : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                      : -1;
    };
    std::string out;
    for (size_t i = 0; i < uri.size(); ++i) {
        if (uri[i] == '%' && i + 2 < uri.size() && digit(uri[i + 1]) >= 0 && digit(uri[i + 2]) >= 0) {
            out += char(digit(uri[i + 1]) * 16 + digit(uri[i + 2]));
            i += 2;
        } else {
            out += uri[i];
        }
    }
    return out;
}

/// Bytes of buffers that are no data URIs, by the name that the document now gives them.
using BufferFiles = std::map<std::string, std::vector<std::byte>>;

Status resolveBuffer(const Source& source, const Chunks& chunks, size_t index, Json& buffer, BufferFiles& files) {
    if (!buffer.is_object() || !buffer.contains("byteLength") || !buffer["byteLength"].is_number_unsigned())
        return refuse(source, fmt::format("buffer {} has no byteLength; export it again", index));
    const auto length = buffer["byteLength"].get<uint64_t>();
    const auto uri = buffer.find("uri");
    std::vector<std::byte> bytes;
    if (uri == buffer.end()) {
        if (index != 0 || !chunks.isGlb)
            return refuse(source, fmt::format("buffer {} has no uri; export it without compression", index));
        bytes.assign(chunks.binary.begin(), chunks.binary.end());
    } else {
        if (!uri->is_string()) return refuse(source, fmt::format("buffer {}: its uri is no text", index));
        const auto& text = uri->get_ref<const std::string&>();
        if (text.starts_with("data:")) return {};
        if (!source.siblings)
            return refuse(source, fmt::format("buffer {} is the file {}, but only memory is read", index, text));
        if (Status s = readInputFile(source.folder / decodePercent(text), bytes); !s.ok())
            return {s.outcome, fmt::format("{}: buffer {}: {}", source.name, index, s.message)};
    }
    if (length > bytes.size() || length == 0)
        return refuse(source, fmt::format("buffer {} holds {} bytes, but {} are promised; export it again", index,
                                          bytes.size(), length));
    bytes.resize(length);
    const std::string key = fmt::format("buffer-{}", index);
    buffer["uri"] = key;
    files[key] = std::move(bytes);
    return {};
}

/// Leaves in the document what the reader asks of it.
Status reduceDocument(const Source& source, const Chunks& chunks, Json& json, BufferFiles& files) {
    if (!json.is_object()) return refuse(source, "its JSON is no object; export it again");
    const auto asset = json.find("asset");
    const bool versioned =
        asset != json.end() && asset->is_object() && asset->contains("version") && (*asset)["version"].is_string();
    if (!versioned) return refuse(source, "it has no asset.version; check that this is glTF");
    const auto version = (*asset)["version"].get<std::string>();
    if (!version.starts_with("2.")) return refuse(source, fmt::format("glTF version {}; export it as 2.0", version));
    if (Status s = checkExtensions(source, json); !s.ok()) return s;
    for (const char* unused : {"images", "textures", "samplers", "animations", "cameras", "extras", "extensions"}) {
        json.erase(unused);
    }
    const auto buffers = json.find("buffers");
    if (buffers == json.end() || !buffers->is_array()) return {};
    for (size_t i = 0; i < buffers->size(); ++i) {
        if (Status s = resolveBuffer(source, chunks, i, (*buffers)[i], files); !s.ok()) return s;
    }
    return {};
}

bool fileExists(const std::string& name, void* files) {
    return static_cast<BufferFiles*>(files)->contains(name);
}
bool takeFile(std::vector<unsigned char>* out, std::string*, const std::string& name, void* files) {
    std::vector<std::byte>& bytes = (*static_cast<BufferFiles*>(files))[name];
    out->resize(bytes.size());
    std::memcpy(out->data(), bytes.data(), bytes.size());
    bytes = {};
    return true;
}
std::string samePath(const std::string& name, void*) {
    return name;
}
bool refuseWriting(std::string*, const std::string&, const std::vector<unsigned char>&, void*) {
    return false;
}
bool ignoreImage(tinygltf::Image*, const int, std::string*, std::string*, int, int, const unsigned char*, int, void*) {
    return true;
}

std::string oneLine(std::string text) {
    while (!text.empty() && text.back() == '\n') text.pop_back();
    std::ranges::replace(text, '\n', ' ');
    return text.empty() ? "it cannot be parsed" : text;
}

} // namespace

Status parseGltf(const Source& source, tinygltf::Model& out) {
    Chunks chunks{{reinterpret_cast<const char*>(source.bytes.data()), source.bytes.size()}, {}, false};
    if (source.extension == ".glb") {
        if (Status s = splitGlb(source, chunks); !s.ok()) return s;
    }
    if (isTooDeep(chunks.json)) return refuse(source, "its JSON is nested too deeply; export it again");
    Json json = Json::parse(chunks.json.begin(), chunks.json.end(), nullptr, false);
    if (json.is_discarded()) return refuse(source, "its JSON is truncated or damaged; export it again");
    BufferFiles files;
    if (Status s = reduceDocument(source, chunks, json, files); !s.ok()) return s;
    const std::string text = json.dump(-1, ' ', false, Json::error_handler_t::replace);
    json = nullptr;
    if (text.size() > 0xffffffffu) return refuse(source, "its JSON is larger than 4 GiB; split the model");

    tinygltf::TinyGLTF loader;
    loader.SetImageLoader(ignoreImage, nullptr);
    loader.SetFsCallbacks({fileExists, samePath, takeFile, refuseWriting, &files});
    std::string error, warning;
    if (!loader.LoadASCIIFromString(&out, &error, &warning, text.data(), unsigned(text.size()), ""))
        return refuse(source, oneLine(error) + "; export it again");
    return {};
}

} // namespace xgc::bake
