#include <xgc/bake/segment.h>

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <fstream>

namespace xgc::bake {

namespace {

/// What a message quotes of a line: short and printable, whatever the file holds.
std::string quote(std::string_view line) {
    constexpr size_t kLongest = 24;
    std::string text;
    for (const char c : line.substr(0, kLongest)) text += (c >= ' ' && c <= '~') ? c : '?';
    if (line.size() > kLongest) text += "...";
    return text;
}

std::string_view trim(std::string_view line) {
    const size_t first = line.find_first_not_of(" \t\r");
    if (first == std::string_view::npos) return {};
    return line.substr(first, line.find_last_not_of(" \t\r") - first + 1);
}

Status parseLine(std::string_view line, const std::string& name, uint32_t number, uint32_t& label) {
    const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), label);
    if (error == std::errc::result_out_of_range || (error == std::errc{} && label == kNone)) {
        return badInput(fmt::format("{}: line {}: '{}' is too large for a part id; the largest is {}", name, number,
                                    quote(line), kNone - 1));
    }
    if (error != std::errc{} || end != line.data() + line.size()) {
        return badInput(fmt::format("{}: line {}: '{}' is not a part id; each line holds one integer, 0 or more", name,
                                    number, quote(line)));
    }
    return {};
}

} // namespace

Status parseSeg(std::string_view text, const std::string& name, uint32_t inputFaceCount,
                std::vector<uint32_t>& inputLabels) {
    const size_t last = text.find_last_not_of(" \t\r\n");
    text = text.substr(0, last == std::string_view::npos ? 0 : last + 1);
    std::vector<uint32_t> labels;
    while (!text.empty()) {
        if (labels.size() == inputFaceCount) {
            return badInput(fmt::format("{}: more lines than the model has faces ({}); was it made for another model?",
                                        name, inputFaceCount));
        }
        const size_t end = text.find('\n');
        uint32_t label = 0;
        if (Status s = parseLine(trim(text.substr(0, end)), name, uint32_t(labels.size()) + 1, label); !s.ok())
            return s;
        labels.push_back(label);
        text = end == std::string_view::npos ? std::string_view{} : text.substr(end + 1);
    }
    if (labels.size() < inputFaceCount) {
        return badInput(fmt::format("{}: {} lines for a model of {} faces; was it made for another model?", name,
                                    labels.size(), inputFaceCount));
    }
    inputLabels = std::move(labels);
    return {};
}

Status readSegFile(const std::filesystem::path& file, uint32_t inputFaceCount, std::vector<uint32_t>& inputLabels) {
    const std::string name = file.string();
    std::error_code error;
    if (std::filesystem::is_directory(file, error)) return badInput(name + ": is a directory, not a .seg file");
    if (!std::filesystem::exists(file, error)) return badInput(name + ": no such file");
    std::ifstream stream(file, std::ios::binary);
    if (!stream) return badInput(name + ": cannot be opened; check its permissions");
    // Some room for blanks, and an end to what a mistaken name can make us read.
    const uint64_t mostBytes = uint64_t(inputFaceCount) * 64 + 4096;
    std::string text;
    std::array<char, 65536> block;
    while (stream.read(block.data(), block.size()) || stream.gcount() > 0) {
        text.append(block.data(), size_t(stream.gcount()));
        if (text.size() > mostBytes) {
            return badInput(fmt::format("{}: far too long for the labels of {} faces; is it a .seg file of this model?",
                                        name, inputFaceCount));
        }
    }
    if (stream.bad()) return badInput(name + ": cannot be read");
    return parseSeg(text, name, inputFaceCount, inputLabels);
}

} // namespace xgc::bake
