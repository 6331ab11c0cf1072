#pragma once

#include <string>
#include <vector>

/// A frame of the flight.
struct Sample {
    double errorPixels = 0; ///< the largest of what is drawn, in sight
    double residentBytes = 0;
    double readBytes = 0; ///< since the start
    double triangles = 0;
};

/// Writes the flight as a picture: error and memory by frame, and error against the bytes read by then.
bool writeChart(const std::string& file, const std::vector<Sample>& samples, double budgetBytes, double sceneBytes);
