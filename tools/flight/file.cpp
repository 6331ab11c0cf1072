#include <xgc/bake/flight.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <charconv>
#include <cmath>
#include <fstream>

namespace xgc::bake {
namespace {

using Json = nlohmann::json;

constexpr int kVersion = 1;

/// Says what is wrong with the element under way.
struct Bad {
    std::string what;
};

std::string hex(uint64_t value) {
    return fmt::format("{:016x}", value);
}

uint64_t fromHex(const Json& json) {
    const auto text = json.get<std::string>();
    uint64_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, 16);
    if (error != std::errc{} || end != text.data() + text.size()) throw Bad{"is no hash of 16 hexadecimal digits"};
    return value;
}

/// A number that no field of the runtime would assert on.
float finite(const Json& json, float least) {
    const float value = json.get<float>();
    if (!std::isfinite(value) || !(value >= least)) throw Bad{fmt::format("must be finite and at least {}", least)};
    return value;
}

Json pack(const glm::vec3& v) {
    return {v.x, v.y, v.z};
}

glm::vec3 unpack(const Json& json) {
    if (json.size() != 3) throw Bad{"must be three numbers"};
    glm::vec3 v;
    for (int i = 0; i < 3; ++i) v[i] = finite(json[size_t(i)], -3e38f);
    return v;
}

Json packFrame(const Flight::Frame& frame) {
    const SelectionDesc& d = frame.desc;
    Json json = {{"eye", pack(d.view.eye)},
                 {"pixelsPerUnit", d.view.pixelsPerUnit},
                 {"nearest", d.view.nearest},
                 {"pixels", d.pixels},
                 {"hysteresis", d.hysteresis},
                 {"cullBackfaces", d.cullBackfaces},
                 {"contributionPixels", d.contributionPixels},
                 {"triangleBudget", d.triangleBudget},
                 {"triangles", frame.triangles},
                 {"levels", hex(frame.hashes.levels)},
                 {"draws", hex(frame.hashes.draws)},
                 {"copies", hex(frame.hashes.copies)}};
    if (d.view.orthographic) json["forward"] = pack(d.view.forward);
    if (d.policy == Policy::distanceBands) json["bands"] = frame.bands;
    if (std::isfinite(d.wholeBeyond)) json["wholeBeyond"] = d.wholeBeyond;
    if (d.morph) json["morphRate"] = d.morphRate;
    Json planes = Json::array();
    for (uint32_t i = 0; i < d.frustum.planeCount; ++i) {
        const glm::vec4& p = d.frustum.planes[i];
        planes.push_back({p.x, p.y, p.z, p.w});
    }
    json["frustum"] = planes;
    return json;
}

Frustum unpackFrustum(const Json& json) {
    Frustum frustum;
    if (json.size() > frustum.planes.size()) throw Bad{"has a frustum of more than six planes"};
    for (const Json& plane : json) {
        if (plane.size() != 4) throw Bad{"has a plane that is not four numbers"};
        glm::vec4& p = frustum.planes[frustum.planeCount++];
        for (int i = 0; i < 4; ++i) p[i] = finite(plane[size_t(i)], -3e38f);
    }
    return frustum;
}

Flight::Frame unpackFrame(const Json& json) {
    Flight::Frame frame;
    SelectionDesc& d = frame.desc;
    d.view.eye = unpack(json.at("eye"));
    d.view.pixelsPerUnit = finite(json.at("pixelsPerUnit"), 0);
    d.view.nearest = finite(json.at("nearest"), 0);
    if (json.contains("forward")) {
        d.view.orthographic = true;
        d.view.forward = unpack(json["forward"]);
    }
    d.pixels = finite(json.at("pixels"), 0);
    d.hysteresis = finite(json.at("hysteresis"), 0);
    if (d.hysteresis >= 1) throw Bad{"has a hysteresis that is not below 1"};
    d.cullBackfaces = json.at("cullBackfaces").get<bool>();
    d.contributionPixels = finite(json.at("contributionPixels"), 0);
    d.triangleBudget = json.at("triangleBudget").get<uint32_t>();
    d.wholeBeyond = json.contains("wholeBeyond") ? finite(json["wholeBeyond"], 0) : INFINITY;
    d.frustum = unpackFrustum(json.at("frustum"));
    if (json.contains("bands")) {
        d.policy = Policy::distanceBands;
        for (const Json& band : json["bands"]) frame.bands.push_back(finite(band, -3e38f));
        if (!std::is_sorted(frame.bands.begin(), frame.bands.end())) throw Bad{"has bands that do not rise"};
        if (d.triangleBudget > 0) throw Bad{"has bands and a budget: one of them decides"};
    }
    if (json.contains("morphRate")) {
        d.morph = true;
        d.morphRate = finite(json["morphRate"], 1e-6f);
        if (d.hysteresis > 0 || d.triangleBudget > 0) throw Bad{"morphs with a hysteresis or a budget"};
    }
    frame.triangles = json.at("triangles").get<uint64_t>();
    frame.hashes = {fromHex(json.at("levels")), fromHex(json.at("draws")), fromHex(json.at("copies"))};
    return frame;
}

Flight::Instance unpackInstance(const Json& json, size_t assetCount) {
    Flight::Instance instance;
    instance.asset = json.at("asset").get<uint32_t>();
    if (instance.asset >= assetCount) throw Bad{"names an asset that the flight has not"};
    const Json& columns = json.at("toWorld");
    if (columns.size() != 4) throw Bad{"has a placement that is not four columns"};
    for (int c = 0; c < 4; ++c) instance.toWorld[c] = unpack(columns[size_t(c)]);
    if (instance.toWorld[0] == glm::vec3(0) && instance.toWorld[1] == glm::vec3(0) &&
        instance.toWorld[2] == glm::vec3(0)) {
        throw Bad{"has a placement of zero"};
    }
    return instance;
}

/// Runs `read` for each element of an array, and names the one that fails.
template <typename Read>
void forEach(const Json& json, const char* name, Read read) {
    const Json& array = json.at(name);
    for (size_t i = 0; i < array.size(); ++i) {
        try {
            read(array[i]);
        } catch (const Bad& bad) {
            throw Bad{fmt::format("{}[{}] {}", name, i, bad.what)};
        } catch (const Json::exception& error) {
            throw Bad{fmt::format("{}[{}]: {}", name, i, error.what())};
        }
    }
}

Flight unpackFlight(const Json& json) {
    if (json.value("xgcFlight", 0) != kVersion) {
        throw Bad{fmt::format("is no flight of version {}: record it again", kVersion)};
    }
    Flight flight;
    forEach(json, "assets", [&](const Json& j) {
        flight.assets.push_back({j.at("file").get<std::string>(), fromHex(j.at("hash"))});
    });
    forEach(json, "instances",
            [&](const Json& j) { flight.instances.push_back(unpackInstance(j, flight.assets.size())); });
    flight.arenaBytes = json.at("arenaBytes").get<uint32_t>();
    flight.stagingBytes = json.at("stagingBytes").get<uint32_t>();
    forEach(json, "frames", [&](const Json& j) { flight.frames.push_back(unpackFrame(j)); });
    return flight;
}

} // namespace

Status writeFlight(const Flight& flight, const std::filesystem::path& file) {
    Json json = {{"xgcFlight", kVersion},
                 {"assets", Json::array()},
                 {"instances", Json::array()},
                 {"arenaBytes", flight.arenaBytes},
                 {"stagingBytes", flight.stagingBytes},
                 {"frames", Json::array()}};
    for (const Flight::Asset& asset : flight.assets) {
        json["assets"].push_back({{"file", asset.file}, {"hash", hex(asset.hash)}});
    }
    for (const Flight::Instance& instance : flight.instances) {
        Json columns = Json::array();
        for (int c = 0; c < 4; ++c) columns.push_back(pack(instance.toWorld[c]));
        json["instances"].push_back({{"asset", instance.asset}, {"toWorld", columns}});
    }
    for (const Flight::Frame& frame : flight.frames) json["frames"].push_back(packFrame(frame));
    const std::string text = json.dump(1) + "\n";
    return writeFileAtomically(file, std::as_bytes(std::span(text)));
}

Status readFlight(const std::filesystem::path& file, Flight& out) {
    std::ifstream in(file);
    if (!in) return badInput(fmt::format("{}: cannot read it", file.string()));
    try {
        out = unpackFlight(Json::parse(in));
    } catch (const Bad& bad) {
        return badInput(fmt::format("{}: {}", file.string(), bad.what));
    } catch (const Json::exception& error) {
        return badInput(
            fmt::format("{}: not a flight that xgc_headless --record writes: {}", file.string(), error.what()));
    }
    return {};
}

} // namespace xgc::bake
