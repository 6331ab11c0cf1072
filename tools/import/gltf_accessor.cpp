#include <import/gltf_accessor.h>

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

namespace xgc::bake {

namespace {

template <class T>
T load(const unsigned char* from) {
    T value;
    std::memcpy(&value, from, sizeof value);
    return value;
}

uint64_t componentBytes(int type) {
    switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
        return 1;
    case TINYGLTF_COMPONENT_TYPE_SHORT:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
        return 2;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
    case TINYGLTF_COMPONENT_TYPE_FLOAT:
        return 4;
    default:
        return 0;
    }
}

/// glTF 2.0, section 3.11: normalized integers.
float decodeFloat(const unsigned char* from, int type, bool normalized) {
    switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE: {
        const auto v = float(load<int8_t>(from));
        return normalized ? std::max(v / 127.0f, -1.0f) : v;
    }
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
        return float(*from) / (normalized ? 255.0f : 1.0f);
    case TINYGLTF_COMPONENT_TYPE_SHORT: {
        const auto v = float(load<int16_t>(from));
        return normalized ? std::max(v / 32767.0f, -1.0f) : v;
    }
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
        return float(load<uint16_t>(from)) / (normalized ? 65535.0f : 1.0f);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
        return float(load<uint32_t>(from));
    default:
        return load<float>(from);
    }
}

uint32_t decodeIndex(const unsigned char* from, int type) {
    switch (type) {
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
        return *from;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
        return load<uint16_t>(from);
    default:
        return load<uint32_t>(from);
    }
}

bool isIndexType(int type) {
    return type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE || type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
           type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
}

} // namespace

GltfAccessors::GltfAccessors(const tinygltf::Model& document, std::string file)
    : document_(document), file_(std::move(file)) {
    for (const tinygltf::Buffer& b : document.buffers) bufferBytes_ += b.data.size();
}

Status GltfAccessors::refuse(const std::string& use, const std::string& what) const {
    return badInput(fmt::format("{}: {}: {}; export it again", file_, use, what));
}

int GltfAccessors::components(int accessor) const {
    if (accessor < 0 || size_t(accessor) >= document_.accessors.size()) return 0;
    return tinygltf::GetNumComponentsInType(uint32_t(document_.accessors[size_t(accessor)].type));
}

Status GltfAccessors::check(int accessor, int components, const std::string& use) const {
    if (accessor < 0 || size_t(accessor) >= document_.accessors.size())
        return refuse(use, fmt::format("accessor {} of {}", accessor, document_.accessors.size()));
    const tinygltf::Accessor& a = document_.accessors[size_t(accessor)];
    if (componentBytes(a.componentType) == 0)
        return refuse(use, fmt::format("accessor {} has the component type {}", accessor, a.componentType));
    if (this->components(accessor) != components)
        return refuse(use, fmt::format("accessor {} has {} components where {} are needed", accessor,
                                       this->components(accessor), components));
    // An accessor of zeros costs no bytes: what it stands beside does, so this bounds nothing that is real.
    if (a.count > bufferBytes_)
        return refuse(use, fmt::format("accessor {} promises {} elements, but all buffers hold {} bytes", accessor,
                                       a.count, bufferBytes_));
    return {};
}

Status GltfAccessors::locate(int view, uint64_t offset, uint64_t count, uint64_t size, const std::string& use,
                             bool strided, Elements& out) const {
    if (view < 0 || size_t(view) >= document_.bufferViews.size())
        return refuse(use, fmt::format("buffer view {} of {}", view, document_.bufferViews.size()));
    const tinygltf::BufferView& v = document_.bufferViews[size_t(view)];
    if (v.buffer < 0 || size_t(v.buffer) >= document_.buffers.size())
        return refuse(use, fmt::format("buffer {} of {}", v.buffer, document_.buffers.size()));
    const std::vector<unsigned char>& data = document_.buffers[size_t(v.buffer)].data;
    if (v.byteOffset > data.size() || v.byteLength > data.size() - v.byteOffset)
        return refuse(use, fmt::format("buffer view {} reaches past the {} bytes of its buffer", view, data.size()));
    const uint64_t stride = strided && v.byteStride != 0 ? v.byteStride : size;
    if (stride < size) return refuse(use, fmt::format("buffer view {} has a stride below its elements' size", view));
    const bool fits = count == 0 || (offset <= v.byteLength && size <= v.byteLength - offset &&
                                     count - 1 <= (v.byteLength - offset - size) / stride);
    if (!fits)
        return refuse(use,
                      fmt::format("{} elements reach past the {} bytes of buffer view {}", count, v.byteLength, view));
    out = {data.data() + v.byteOffset + (count == 0 ? 0 : offset), size_t(stride)};
    return {};
}

template <class T, class Decode>
Status GltfAccessors::read(int accessor, int components, const std::string& use, const Decode& decode,
                           std::vector<T>& out) const {
    if (Status s = check(accessor, components, use); !s.ok()) return s;
    const tinygltf::Accessor& a = document_.accessors[size_t(accessor)];
    const uint64_t part = componentBytes(a.componentType), size = part * uint64_t(components);
    Elements dense, sparseIndices, sparseValues;
    if (a.bufferView != -1) {
        if (Status s = locate(a.bufferView, a.byteOffset, a.count, size, use, true, dense); !s.ok()) return s;
    }
    const auto sparseCount = a.sparse.isSparse ? a.sparse.count : 0;
    const int indexType = a.sparse.isSparse ? a.sparse.indices.componentType : 0;
    if (a.sparse.isSparse) {
        if (sparseCount < 0 || a.sparse.indices.byteOffset < 0 || a.sparse.values.byteOffset < 0 ||
            !isIndexType(indexType))
            return refuse(use, fmt::format("accessor {} has a broken sparse part", accessor));
        const auto count = uint64_t(sparseCount);
        if (Status s = locate(a.sparse.indices.bufferView, uint64_t(a.sparse.indices.byteOffset), count,
                              componentBytes(indexType), use, false, sparseIndices);
            !s.ok())
            return s;
        if (Status s = locate(a.sparse.values.bufferView, uint64_t(a.sparse.values.byteOffset), count, size, use, false,
                              sparseValues);
            !s.ok())
            return s;
    }
    const auto width = size_t(components);
    out.assign(a.count * width, T(0));
    const auto decodeElement = [&](const unsigned char* from, size_t to) {
        for (size_t k = 0; k < width; ++k) out[to * width + k] = decode(from + k * part, a.componentType, a.normalized);
    };
    for (size_t i = 0; dense.data && i < a.count; ++i) decodeElement(dense.data + i * dense.stride, i);
    for (size_t i = 0; i < size_t(sparseCount); ++i) {
        const uint32_t to = decodeIndex(sparseIndices.data + i * sparseIndices.stride, indexType);
        if (to >= a.count)
            return refuse(use,
                          fmt::format("accessor {} has a sparse index {} past its {} elements", accessor, to, a.count));
        decodeElement(sparseValues.data + i * sparseValues.stride, to);
    }
    return {};
}

Status GltfAccessors::readFloats(int accessor, int components, const std::string& use, std::vector<float>& out) const {
    return read(accessor, components, use, decodeFloat, out);
}

Status GltfAccessors::readIndices(int accessor, int components, const std::string& use,
                                  std::vector<uint32_t>& out) const {
    if (Status s = check(accessor, components, use); !s.ok()) return s;
    const int type = document_.accessors[size_t(accessor)].componentType;
    if (!isIndexType(type)) return refuse(use, fmt::format("accessor {} has the component type {}", accessor, type));
    return read(
        accessor, components, use, [](const unsigned char* from, int t, bool) { return decodeIndex(from, t); }, out);
}

} // namespace xgc::bake
