#include <mesh/attribute_rows.h>

#include <fmt/format.h>
#include <xxhash.h>

#include <cmath>
#include <cstring>

namespace xgc::bake {

AttributeRows::AttributeRows(const Attributes& a) {
    add(a.normals, "normal");
    add(a.tangents, "tangent");
    for (size_t i = 0; i < a.uvs.size(); ++i) add(a.uvs[i], fmt::format("UV {}", i));
    for (size_t i = 0; i < a.colors.size(); ++i) add(a.colors[i], fmt::format("colour {}", i));
    for (size_t i = 0; i < a.joints.size(); ++i) add(a.joints[i], fmt::format("joints {}", i), false);
    for (size_t i = 0; i < a.weights.size(); ++i) add(a.weights[i], fmt::format("weights {}", i));
    for (size_t i = 0; i < a.morphTargets.size(); ++i) {
        const MorphTarget& t = a.morphTargets[i];
        add(t.positions, fmt::format("position of morph target {}", i));
        add(t.normals, fmt::format("normal of morph target {}", i));
        add(t.tangents, fmt::format("tangent of morph target {}", i));
    }
}

uint64_t AttributeRows::hash(uint32_t row) const {
    uint64_t h = 0;
    for (const Column& c : columns_) h = XXH64(c.data + row * c.stride, c.stride, h);
    return h;
}

bool AttributeRows::equal(uint32_t a, uint32_t b) const {
    for (const Column& c : columns_) {
        if (std::memcmp(c.data + a * c.stride, c.data + b * c.stride, c.stride) != 0) return false;
    }
    return true;
}

std::string AttributeRows::check(size_t rowCount, uint32_t& row) const {
    row = kNone;
    for (const Column& c : columns_) {
        if (c.count != rowCount)
            return fmt::format("the column \"{}\" has {} rows for {} vertices", c.name, c.count, rowCount);
        if (!c.isFloat) continue;
        const size_t perRow = c.stride / sizeof(float), count = c.count * perRow;
        const auto* values = reinterpret_cast<const float*>(c.data);
        for (size_t i = 0; i < count; ++i) {
            if (std::isfinite(values[i])) continue;
            row = uint32_t(i / perRow);
            return fmt::format("the {} is not finite", c.name);
        }
    }
    return {};
}

namespace {

template <class T>
std::vector<T> gather(const std::vector<T>& column, const std::vector<uint32_t>& rows) {
    std::vector<T> out;
    if (column.empty()) return out;
    out.reserve(rows.size());
    for (const uint32_t r : rows) out.push_back(column[r]);
    return out;
}

} // namespace

Attributes gatherAttributes(const Attributes& a, const std::vector<uint32_t>& rows) {
    Attributes out;
    out.normals = gather(a.normals, rows);
    out.tangents = gather(a.tangents, rows);
    for (size_t i = 0; i < a.uvs.size(); ++i) out.uvs[i] = gather(a.uvs[i], rows);
    for (size_t i = 0; i < a.colors.size(); ++i) out.colors[i] = gather(a.colors[i], rows);
    for (size_t i = 0; i < a.joints.size(); ++i) out.joints[i] = gather(a.joints[i], rows);
    for (size_t i = 0; i < a.weights.size(); ++i) out.weights[i] = gather(a.weights[i], rows);
    for (const MorphTarget& t : a.morphTargets) {
        out.morphTargets.push_back(
            {t.name, gather(t.positions, rows), gather(t.normals, rows), gather(t.tangents, rows)});
    }
    return out;
}

} // namespace xgc::bake
