#include <import/obj_text.h>

#include <map>
#include <string_view>

namespace xgc::bake {

namespace {

constexpr std::string_view kBlank = " \t\r\n\v\f";

/// A statement: lines joined where they end in a backslash, blanks around it cut.
std::string_view nextStatement(std::string_view& rest) {
    size_t end = 0;
    for (;;) {
        end = rest.find('\n', end);
        if (end == std::string_view::npos) {
            end = rest.size();
            break;
        }
        const size_t last = end > 0 && rest[end - 1] == '\r' ? end - 2 : end - 1;
        if (last >= end || rest[last] != '\\') break; // an empty line wraps round
        ++end;
    }
    std::string_view line = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    const size_t first = line.find_first_not_of(kBlank);
    if (first == std::string_view::npos) return {};
    line.remove_prefix(first);
    return line.substr(0, line.find_last_not_of(kBlank) + 1);
}

/// Numbers names by first use.
class Names {
public:
    void set(std::string_view name) {
        name_ = name;
        number_ = kNone;
    }
    uint32_t use(std::vector<std::string>& names) {
        if (number_ != kNone || name_.empty()) return number_;
        const auto [it, isNew] = numbers_.try_emplace(std::string(name_), uint32_t(names.size()));
        if (isNew) names.emplace_back(name_);
        return number_ = it->second;
    }

private:
    std::string_view name_;
    uint32_t number_ = kNone;
    std::map<std::string, uint32_t> numbers_;
};

} // namespace

ObjText splitObj(std::span<const std::byte> bytes) {
    std::string_view rest(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    ObjText obj;
    obj.text.reserve(bytes.size() + 1);
    Names group, material;
    while (!rest.empty()) {
        const std::string_view statement = nextStatement(rest);
        const size_t keyEnd = std::min(statement.find_first_of(kBlank), statement.size());
        const std::string_view key = statement.substr(0, keyEnd);
        const size_t valueStart = std::min(statement.find_first_not_of(kBlank, keyEnd), statement.size());
        const std::string_view value = statement.substr(valueStart);
        if (key == "o" || key == "g") group.set(value);
        if (key == "usemtl") material.set(value);
        if (key == "f") {
            obj.faceGroup.push_back(group.use(obj.groups));
            obj.faceMaterial.push_back(material.use(obj.materials));
        }
        if (key == "f" || key == "v" || key == "vt" || key == "vn" || key == "mtllib") {
            obj.text += statement;
            obj.text += '\n';
        }
    }
    return obj;
}

} // namespace xgc::bake
