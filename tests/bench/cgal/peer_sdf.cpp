#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/boost/graph/IO/OFF.h>
#include <CGAL/mesh_segmentation.h>

#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

/// CGAL's segmentation by the shape diameter function, for `xgc eval psb --labels sdf=OUT`: for every N.off of a folder
/// the labels OUT/N.seg, and in OUT/seconds.txt what each took of the processor (values, clusters and cut, without
/// reading and writing). One thread. A mesh that CGAL refuses has one part.
///
///     peer_sdf OFF OUT [--clusters N] [--smoothing L]      (CGAL's defaults: 5 and .26)
namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using SurfaceMesh = CGAL::Surface_mesh<Kernel::Point_3>;
using Face = SurfaceMesh::Face_index;

struct Settings {
    std::size_t clusters = 5;
    double smoothing = 0.26;
};

/// Labels in the order of the file's faces, which is that of the mesh's indices.
std::vector<std::size_t> segment(const SurfaceMesh& mesh, const Settings& settings) {
    std::vector<double> values(mesh.number_of_faces());
    std::vector<std::size_t> labels(mesh.number_of_faces());
    const auto index = get(boost::face_index, mesh);
    const auto valueMap = boost::make_iterator_property_map(values.begin(), index);
    const auto labelMap = boost::make_iterator_property_map(labels.begin(), index);
    CGAL::sdf_values(mesh, valueMap);
    CGAL::segmentation_from_sdf_values(mesh, valueMap, labelMap, settings.clusters, settings.smoothing);
    return labels;
}

/// Faces of an OFF file: the second number after its first word.
std::size_t faceCount(const std::filesystem::path& file) {
    std::ifstream in(file);
    std::string magic;
    std::size_t vertices = 0, faces = 0;
    in >> magic >> vertices >> faces;
    return in ? faces : 0;
}

bool writeLabels(const std::filesystem::path& file, const std::vector<std::size_t>& labels) {
    std::ofstream out(file);
    for (const std::size_t label : labels) out << label << '\n';
    return bool(out.flush());
}

/// Numbers of the models in a folder.
std::map<unsigned long, std::filesystem::path> modelsOf(const std::filesystem::path& folder) {
    std::map<unsigned long, std::filesystem::path> models;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        if (entry.path().extension() != ".off") continue;
        if (const unsigned long number = std::strtoul(entry.path().stem().c_str(), nullptr, 10)) {
            models[number] = entry.path();
        }
    }
    return models;
}

int run(const std::filesystem::path& off, const std::filesystem::path& out, const Settings& settings) {
    std::filesystem::create_directories(out);
    std::ofstream times(out / "seconds.txt");
    double sum = 0;
    const auto models = modelsOf(off);
    for (const auto& [number, file] : models) {
        const std::size_t faces = faceCount(file);
        SurfaceMesh mesh;
        std::vector<std::size_t> labels(faces, 0);
        double seconds = 0;
        if (CGAL::IO::read_OFF(file.string(), mesh) && mesh.number_of_faces() == faces &&
            CGAL::is_triangle_mesh(mesh)) {
            const std::clock_t start = std::clock();
            labels = segment(mesh, settings);
            seconds = double(std::clock() - start) / CLOCKS_PER_SEC;
        } else {
            std::fprintf(stderr, "peer_sdf: %s: refused by CGAL; one part\n", file.c_str());
        }
        if (!writeLabels(out / (std::to_string(number) + ".seg"), labels)) {
            std::fprintf(stderr, "peer_sdf: %s: labels of model %lu cannot be written\n", out.c_str(), number);
            return 4;
        }
        sum += seconds;
        times << number << ' ' << seconds << '\n';
        std::printf("%4lu %7zu faces %8.3f s\n", number, faces, seconds);
        std::fflush(stdout);
    }
    std::printf("%zu models, %.2f s\n", models.size(), sum);
    return 0;
}

} // namespace

int main(int argc, char** argv) {
    Settings settings;
    std::vector<std::string> folders;
    for (int i = 1; i < argc; ++i) {
        const std::string argument = argv[i];
        if (argument == "--clusters" && i + 1 < argc) {
            settings.clusters = std::strtoul(argv[++i], nullptr, 10);
        } else if (argument == "--smoothing" && i + 1 < argc) {
            settings.smoothing = std::strtod(argv[++i], nullptr);
        } else {
            folders.push_back(argument);
        }
    }
    if (folders.size() != 2 || !std::filesystem::is_directory(folders[0])) {
        std::fprintf(stderr, "usage: peer_sdf OFF OUT [--clusters N] [--smoothing L]\n");
        return 2;
    }
    return run(folders[0], folders[1], settings);
}
