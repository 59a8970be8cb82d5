#pragma once
// What GeoTIFF adds to heights: where they lie on the earth, and how far apart.
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <vector>

namespace apertura {

class PipeReader;  // runtime/asset/isolated.h
class PipeWriter;

// The tags by which a TIFF says where it lies ("OGC GeoTIFF Standard", 2019), as they are in the file; all empty where there are none.
struct Georeference {
    std::vector<double> pixelScale, tiePoints, transformation, numbers;
    std::vector<uint16_t> keys;
    std::vector<char> text;

    void send(PipeWriter& out) const;
    static Georeference receive(PipeReader& in);
};

// The grid that these describe.
struct MapGrid {
    double spacingX = 0, spacingZ = 0;  // metres between texels, to the east and to the south; 0: not known
    double latitude = 0;                // degrees, of the middle
    bool isGeographic = false;          // its cells are of degrees; the latitude is known
    std::string fault;                  // why nothing is known of its spacing; empty where the file says nothing of it at all
    std::string note;                   // what a user should know of it
    bool isTurned = false;              // its rows do not go from north to south, or its columns not from west to east
};

struct GeoTiff {
    float noData = std::numeric_limits<float>::quiet_NaN();  // the number that stands for "no data", as GDAL writes it; NaN: none
    double scale = 1, offset = 0;                            // a height in metres is scale number + offset, by GDAL's metadata
    Georeference georeference;
    MapGrid grid;
};

// Reads the tags of a TIFF in this process. Cells of degrees become metres at the latitude of the middle of the map, by the file's
// ellipsoid, and so do cells of Mercator's projection, which grow with the latitude. `width`, `height`: of the image, texels. Of Error it
// throws nothing: of a damaged file it returns what can be read.
GeoTiff readGeoTiff(const std::string& path, int width, int height);

// Writes a TIFF of 32-bit floats, one plane a band, compressed without loss, with -9999 for NaN. It appears whole or not at all.
//   descriptions  of the bands
//   writeBands    calls its argument with the index of a band, a row, a multiple of rowsAStrip(width), and the numbers from there on, row
//                 after row, a multiple of as many or up to the last one: for each band and row once, in any order
// Throws Error naming the path where it cannot be written.
void writeGeoTiff(const std::string& path, int width, int height, const Georeference& georeference,
                  const std::vector<std::string>& descriptions,
                  const std::function<void(const std::function<void(int, int, std::span<const float>)>&)>& writeBands);
int rowsAStrip(int width);

constexpr float kNoData = -9999;

}  // namespace apertura
