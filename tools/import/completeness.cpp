#include <import/completeness.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <string_view>
#include <vector>

namespace xgc::bake {

namespace {

constexpr std::string_view kBlank = " \t\r\n\v\f";

std::string_view nextToken(std::string_view& rest) {
    rest.remove_prefix(std::min(rest.find_first_not_of(kBlank), rest.size()));
    const std::string_view token = rest.substr(0, rest.find_first_of(kBlank));
    rest.remove_prefix(token.size());
    return token;
}

std::string_view nextLine(std::string_view& rest) {
    const std::string_view line = rest.substr(0, rest.find('\n'));
    rest.remove_prefix(std::min(line.size() + 1, rest.size()));
    return line;
}

/// A line with something on it besides a comment; empty at the end.
std::string_view nextFullLine(std::string_view& rest) {
    while (!rest.empty()) {
        const std::string_view line = nextLine(rest);
        const size_t first = line.find_first_not_of(kBlank);
        if (first != std::string_view::npos && line[first] != '#') return line.substr(first);
    }
    return {};
}

size_t countTokens(std::string_view line) {
    size_t count = 0;
    while (!nextToken(line).empty()) ++count;
    return count;
}

/// Of a decimal number; text that is none counts as 0, a number past 64 bits as the largest.
uint64_t valueOf(std::string_view number) {
    uint64_t value = 0;
    const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), value);
    return error == std::errc::result_out_of_range ? ~uint64_t(0) : error == std::errc() ? value : 0;
}

class Completeness {
public:
    explicit Completeness(const Source& source)
        : source_(source), rest_(reinterpret_cast<const char*>(source.bytes.data()), source.bytes.size()) {}

    /// Assimp reads a vertex or a face a line.
    Status checkOff() {
        std::string_view line = nextFullLine(rest_);
        std::string_view first = nextToken(line);
        if (!first.ends_with("OFF")) return refuse("\"OFF\" is missing; check the extension");
        if (line.find_first_not_of(kBlank) == std::string_view::npos) line = nextFullLine(rest_);
        const std::string_view vertices = nextToken(line), faces = nextToken(line);
        if (valueOf(vertices) > source_.bytes.size()) return tooMany(vertices, "vertices");
        if (valueOf(faces) > source_.bytes.size()) return tooMany(faces, "faces");
        const uint64_t vertexCount = valueOf(vertices), promised = vertexCount + valueOf(faces);
        for (uint64_t i = 0; i < promised; ++i) {
            line = nextFullLine(rest_);
            if (line.empty())
                return truncated(fmt::format("{} lines of vertices and faces are promised, {} are there", promised, i));
            if (i < vertexCount) continue;
            if (Status s = checkOffFace(line, i - vertexCount, vertexCount); !s.ok()) return s;
        }
        return {};
    }

    Status checkPly() {
        if (Status s = readPlyHeader(); !s.ok() || !isAscii_) return s;
        for (const Element& element : elements_) {
            for (uint64_t i = 0; i < element.count; ++i) {
                for (const bool isList : element.propertyIsList) {
                    const std::string_view token = nextToken(rest_);
                    bool missing = token.empty();
                    for (uint64_t k = isList ? valueOf(token) : 0; k > 0 && !missing; --k) {
                        missing = nextToken(rest_).empty();
                    }
                    if (missing)
                        return truncated(
                            fmt::format("it ends in the element {} {} of {}", element.name, i, element.count));
                }
            }
        }
        return {};
    }

    /// Binary files are counted by Assimp: it takes those for binary whose size agrees with their count.
    Status checkStl() {
        std::string_view probe = rest_;
        if (nextToken(probe) != "solid" || isBinaryStl()) return {};
        uint64_t facets = 0, ends = 0, vertices = 0;
        std::string_view key;
        while (!rest_.empty()) {
            std::string_view line = nextLine(rest_);
            const std::string_view first = nextToken(line);
            if (first.empty()) continue;
            key = first;
            facets += key == "facet";
            ends += key == "endfacet";
            vertices += key == "vertex" && countTokens(line) >= 3;
        }
        if (!key.starts_with("endsolid") || facets != ends || vertices != 3 * facets)
            return truncated(fmt::format("{} facets begin, {} end, {} vertices are whole", facets, ends, vertices));
        return {};
    }

private:
    struct Element {
        std::string_view name;
        uint64_t count = 0;
        std::vector<bool> propertyIsList;
    };

    /// Assimp takes the last vertex for one past the last, and what comes after the faces for a face where one has none
    /// or too many corners.
    Status checkOffFace(std::string_view line, uint64_t face, uint64_t vertexCount) const {
        constexpr uint64_t kMostCorners = 9; // that it reads
        const std::string_view corners = nextToken(line);
        const uint64_t count = valueOf(corners);
        if (count > kMostCorners)
            return refuse(
                fmt::format("face {} has {} corners, and {} can be read; triangulate it", face, corners, kMostCorners));
        if (count == 0) return truncated(fmt::format("face {} has no corners", face));
        for (uint64_t left = count; left > 0; --left) {
            const std::string_view index = nextToken(line);
            if (index.empty()) return truncated(fmt::format("face {} is cut off", face));
            if (index[0] < '0' || index[0] > '9' || valueOf(index) >= vertexCount)
                return truncated(fmt::format("face {} names the vertex {} of {}", face, index, vertexCount));
        }
        return {};
    }

    Status refuse(std::string_view what) const { return badInput(fmt::format("{}: {}", source_.name, what)); }
    Status truncated(std::string_view what) const {
        return refuse(fmt::format("truncated or damaged: {}; export it again", what));
    }
    Status tooMany(std::string_view count, std::string_view what) const {
        return truncated(
            fmt::format("its header promises {} {}, more than {} bytes can hold", count, what, source_.bytes.size()));
    }

    bool isBinaryStl() const {
        if (source_.bytes.size() < 84) return false;
        uint64_t count = 0;
        for (size_t i = 0; i < 4; ++i) count |= uint64_t(source_.bytes[80 + i]) << (8 * i);
        return source_.bytes.size() == 84 + 50 * count;
    }

    Status readPlyHeader() {
        constexpr std::array<std::string_view, 3> kIgnored = {"ply", "comment", "obj_info"};
        for (int number = 1; !rest_.empty(); ++number) {
            const bool ended = rest_.find('\n') != std::string_view::npos;
            std::string_view line = nextLine(rest_);
            const std::string_view key = nextToken(line);
            if (number == 1 && key != "ply") return refuse("\"ply\" is missing; check the extension");
            if (key == "end_header" && ended) return {};
            if (key == "format") {
                isAscii_ = nextToken(line) == "ascii";
            } else if (key == "element") {
                const std::string_view name = nextToken(line), count = nextToken(line);
                if (valueOf(count) > source_.bytes.size()) return tooMany(count, name);
                elements_.push_back({name, valueOf(count), {}});
            } else if (key == "property" && !elements_.empty()) {
                elements_.back().propertyIsList.push_back(nextToken(line) == "list");
            } else if (std::ranges::find(kIgnored, key) == kIgnored.end()) {
                return truncated(fmt::format("line {} of its header is none of PLY's", number));
            }
        }
        return truncated("its header has no end");
    }

    const Source& source_;
    std::string_view rest_;
    bool isAscii_ = false;
    std::vector<Element> elements_;
};

} // namespace

Status checkComplete(const Source& source) {
    if (source.extension == ".off") return Completeness(source).checkOff();
    if (source.extension == ".ply") return Completeness(source).checkPly();
    if (source.extension == ".stl") return Completeness(source).checkStl();
    return {};
}

} // namespace xgc::bake
