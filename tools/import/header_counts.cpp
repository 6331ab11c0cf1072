#include <import/header_counts.h>

#include <fmt/format.h>

#include <charconv>
#include <string_view>

namespace xgc::bake {

namespace {

std::string_view nextToken(std::string_view& rest) {
    constexpr std::string_view kBlank = " \t\r\n\v\f";
    for (;;) {
        rest.remove_prefix(std::min(rest.find_first_not_of(kBlank), rest.size()));
        if (rest.empty() || rest[0] != '#') break;
        rest.remove_prefix(std::min(rest.find('\n'), rest.size()));
    }
    const std::string_view token = rest.substr(0, rest.find_first_of(kBlank));
    rest.remove_prefix(token.size());
    return token;
}

bool isTooMany(std::string_view number, size_t bytes) {
    uint64_t count = 0;
    const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), count);
    return error == std::errc::result_out_of_range || (error == std::errc() && count > bytes);
}

Status tooMany(const Source& source, std::string_view what, std::string_view number) {
    return badInput(fmt::format("{}: its header promises {} {}, more than a file of {} bytes can hold; it is "
                                "truncated or damaged: export it again",
                                source.name, number, what, source.bytes.size()));
}

} // namespace

Status checkHeaderCounts(const Source& source) {
    std::string_view rest(reinterpret_cast<const char*>(source.bytes.data()), source.bytes.size());
    if (source.extension == ".off") {
        std::string_view token = nextToken(rest);
        if (token.ends_with("OFF")) token = nextToken(rest);
        if (isTooMany(token, source.bytes.size())) return tooMany(source, "vertices", token);
        token = nextToken(rest);
        if (isTooMany(token, source.bytes.size())) return tooMany(source, "faces", token);
    }
    if (source.extension == ".ply") {
        for (std::string_view token = nextToken(rest); !token.empty() && token != "end_header";
             token = nextToken(rest)) {
            if (token != "element") continue;
            const std::string_view what = nextToken(rest), count = nextToken(rest);
            if (isTooMany(count, source.bytes.size())) return tooMany(source, what, count);
        }
    }
    return {};
}

} // namespace xgc::bake
