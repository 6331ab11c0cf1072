#pragma once

#include <import/readers.h>

#include <assimp/IOSystem.hpp>

namespace xgc::bake {

/// Gives Assimp the model's bytes under a name, and sibling files where the source allows them: regular
/// ones only, for reading only.
class AssimpFiles : public Assimp::IOSystem {
public:
    AssimpFiles(const Source& source, std::string mainName) : source_(source), mainName_(std::move(mainName)) {}

    bool Exists(const char* file) const override;
    char getOsSeparator() const override { return '/'; }
    Assimp::IOStream* Open(const char* file, const char* mode) override;
    void Close(Assimp::IOStream* stream) override;

private:
    Source source_;
    std::string mainName_;
};

} // namespace xgc::bake
