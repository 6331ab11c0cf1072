#pragma once

#include <fmt/format.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <vector>

namespace xgc::test {

inline std::string base64(std::span<const unsigned char> bytes) {
    static constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string out;
    for (size_t i = 0; i < bytes.size(); i += 3) {
        uint32_t word = uint32_t(bytes[i]) << 16;
        if (i + 1 < bytes.size()) word |= uint32_t(bytes[i + 1]) << 8;
        if (i + 2 < bytes.size()) word |= uint32_t(bytes[i + 2]);
        for (size_t k = 0; k < 4; ++k) out += i + k > bytes.size() ? '=' : kDigits[word >> (18 - 6 * k) & 63];
    }
    return out;
}

/// Writes small glTF documents by hand: one buffer, a view and an accessor each call.
class GltfText {
public:
    std::string nodes = R"([{"mesh":0}])";
    std::string primitives = "[]";
    std::string more; ///< further members of the document, each with a comma before it

    template <class T>
    int view(const std::vector<T>& values, int stride = 0) {
        while (bytes_.size() % 4) bytes_.push_back(0);
        const size_t at = bytes_.size(), size = values.size() * sizeof(T);
        bytes_.resize(at + size);
        std::memcpy(bytes_.data() + at, values.data(), size);
        add(views_, fmt::format(R"({{"buffer":0,"byteOffset":{},"byteLength":{}{}}})", at, size,
                                stride ? fmt::format(R"(,"byteStride":{})", stride) : std::string()));
        return viewCount_++;
    }
    /// `rest`: further members, each with a comma before it.
    int accessor(int view, int componentType, const std::string& type, size_t count, const std::string& rest = "") {
        add(accessors_, fmt::format(R"({{{}"componentType":{},"type":"{}","count":{}{}}})",
                                    view < 0 ? std::string() : fmt::format(R"("bufferView":{},)", view), componentType,
                                    type, count, rest));
        return accessorCount_++;
    }
    int floats(const std::string& type, int components, const std::vector<float>& values) {
        return accessor(view(values), 5126, type, values.size() / size_t(components));
    }

    std::string json(bool embedded = true) const {
        return fmt::format(
            R"({{"asset":{{"version":"2.0"}},"buffers":[{{"byteLength":{}{}}}],"bufferViews":[{}],"accessors":[{}],)"
            R"("meshes":[{{"primitives":{}}}],"nodes":{}{}}})",
            bytes_.size(),
            embedded ? R"(,"uri":"data:application/octet-stream;base64,)" + base64(bytes_) + '"' : std::string(),
            views_, accessors_, primitives, nodes, more);
    }
    std::vector<std::byte> glb() const {
        std::string text = json(false);
        text.resize((text.size() + 3) / 4 * 4, ' ');
        std::vector<unsigned char> binary = bytes_;
        binary.resize((binary.size() + 3) / 4 * 4, 0);
        std::vector<std::byte> out;
        const auto word = [&](uint32_t v) {
            for (int i = 0; i < 4; ++i) out.push_back(std::byte(v >> (8 * i)));
        };
        word(0x46546c67);
        word(2);
        word(uint32_t(28 + text.size() + binary.size()));
        word(uint32_t(text.size()));
        word(0x4e4f534a);
        for (const char c : text) out.push_back(std::byte(c));
        word(uint32_t(binary.size()));
        word(0x004e4942);
        for (const unsigned char c : binary) out.push_back(std::byte(c));
        return out;
    }

private:
    static void add(std::string& list, const std::string& item) {
        if (!list.empty()) list += ',';
        list += item;
    }
    std::vector<unsigned char> bytes_;
    std::string views_;
    std::string accessors_;
    int viewCount_ = 0;
    int accessorCount_ = 0;
};

} // namespace xgc::test
