#pragma once

#include <xgc/bake/model.h>

#include <cstddef>
#include <string>

namespace xgc::bake {

/// The attributes of a model as rows of bytes, for comparing and hashing them whatever the columns are.
class AttributeRows {
public:
    explicit AttributeRows(const Attributes& attributes);

    bool empty() const { return columns_.empty(); }
    uint64_t hash(uint32_t row) const;
    bool equal(uint32_t a, uint32_t b) const;

    /// "" where all is well, else what is wrong: a column of another length, or a value that is not finite with its
    /// row in `row`.
    std::string check(size_t rowCount, uint32_t& row) const;

private:
    struct Column {
        std::string name;
        const std::byte* data;
        size_t count;
        size_t stride;
        bool isFloat;
    };
    template <class T>
    void add(const std::vector<T>& column, std::string name, bool isFloat = true) {
        if (column.empty()) return;
        columns_.push_back(
            {std::move(name), reinterpret_cast<const std::byte*>(column.data()), column.size(), sizeof(T), isFloat});
    }
    std::vector<Column> columns_;
};

/// The given rows of all attributes, in the order of `rows`.
Attributes gatherAttributes(const Attributes& attributes, const std::vector<uint32_t>& rows);

} // namespace xgc::bake
