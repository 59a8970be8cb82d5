#include "tools/film.h"

#include <sys/wait.h>

#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include "apertura/runtime/asset/error.h"
#include "apertura/runtime/asset/file.h"
#include "tools/commands.h"
#include "tools/terminal.h"

namespace apertura {
namespace {

const std::string kNumber = "%04d";

std::vector<std::pair<double, double>> pointsOf(const std::string& path) {
    std::vector<std::pair<double, double>> out;
    for (size_t from = 0; from <= path.size();) {
        const size_t to = std::min(path.find(':', from), path.size());
        const std::vector<double> n = parseNumbers(path.substr(from, to - from), ',');
        if (n.size() != 2 || std::abs(n[0]) > 3600 || std::abs(n[1]) > 90)
            throw CLI::ValidationError("--sun-path: '" + path + "' is not AZ,EL:AZ,EL in degrees");
        out.emplace_back(n[0], n[1]);
        from = to + 1;
    }
    return out;
}

std::string numbered(const std::string& out, int frame) {
    char digits[16];
    std::snprintf(digits, sizeof digits, "%04d", frame);
    return out.substr(0, out.find(kNumber)) + digits + out.substr(out.find(kNumber) + kNumber.size());
}

// A folder that is gone with this object.
struct TemporaryFolder {
    std::filesystem::path path;
    explicit TemporaryFolder(const std::string& name) {
        std::error_code none;
        std::string pattern = (std::filesystem::temp_directory_path(none) / "apertura-film-XXXXXX").string();
        if (none || !mkdtemp(pattern.data())) throw Error(name + ": no folder for its frames can be made in $TMPDIR or /tmp");
        path = pattern;
    }
    ~TemporaryFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(path, ignored);
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
};

// `film`: its name within the folder, by whose ending it is encoded.
void encode(const std::filesystem::path& folder, const std::string& film, double rate, const std::string& name) {
    // An mp4 has even sides.
    const char* const codec = film.ends_with(".webp") ? "-c:v libwebp_anim -quality 80 -loop 0 "
                                                      : "-vf 'pad=ceil(iw/2)*2:ceil(ih/2)*2' -c:v libx264 -crf 18 -pix_fmt yuv420p ";
    const std::string command = "cd \"$APERTURA_FRAMES\" && ffmpeg -loglevel error -y -framerate " + std::to_string(rate) + " -i %04d.png "
                              + codec + film;
    setenv("APERTURA_FRAMES", folder.c_str(), 1);
    const int status = std::system(command.c_str());
    if (interrupted() || (WIFSIGNALED(status) && WTERMSIG(status) == SIGINT)) throw Cancelled{};
    if (status != 0) throw Error(name + ": ffmpeg, which makes films, failed");
}

}  // namespace

std::vector<std::string> Film::filesOf(const std::string& out) const {
    if (frames == 0 || isFilm(out)) return {out};
    std::vector<std::string> all;
    all.reserve(size_t(frames));
    for (int i = 0; i < frames; ++i) all.push_back(numbered(out, i));
    return all;
}

void Film::check(const std::string& out) const {
    const bool film = isFilm(out), hasNumber = out.find(kNumber) != std::string::npos;
    if (frames == 0 && (film || hasNumber || !sunPath.empty())) throw CLI::ValidationError("--frames says how many frames a film has");
    if (hasNumber && out.find(kNumber) != out.rfind(kNumber)) throw CLI::ValidationError("-o: %04d stands in it twice");
    if (frames > 0 && film == hasNumber) throw CLI::ValidationError("-o: frames are OUT%04d.png or .exr, or a film .mp4 or .webp");
    if (frames > 0 && sunPath.empty()) throw CLI::ValidationError("--frames: --sun-path says what moves");
    if (!sunPath.empty() && pointsOf(sunPath).size() < 2)
        throw CLI::ValidationError("--sun-path: has one point, and goes through two or more");
}

std::pair<double, double> Film::sunIn(int frame) const {
    const auto points = pointsOf(sunPath);
    const double share = frames > 1 ? double(frame) / (frames - 1) : 0, at = share * double(points.size() - 1);
    const size_t first = std::min(size_t(at), points.size() - 1), second = std::min(first + 1, points.size() - 1);
    const double part = at - double(first);
    return {points[first].first + part * (points[second].first - points[first].first),
            points[first].second + part * (points[second].second - points[first].second)};
}

void Film::write(const std::string& out, const std::function<Picture(int)>& draw) const {
    ProgressBar bar("drawing");
    const Progress progress = bar.callback();
    const auto each = [&](const std::function<std::string(int)>& nameOf) {
        for (int i = 0; i < frames; ++i) {
            if (!progress(double(i) / frames)) throw Cancelled{};
            writePicture(nameOf(i), draw(i));
        }
    };
    if (!isFilm(out)) return each([&](int i) { return numbered(out, i); });
    PendingFile file(out);
    const TemporaryFolder folder(out);
    const std::string film = out.ends_with(".webp") ? "film.webp" : "film.mp4";
    each([&](int i) { return (folder.path / numbered("%04d.png", i)).string(); });
    encode(folder.path, film, rate, out);
    const std::vector<unsigned char> bytes = readFile((folder.path / film).string());
    file.writeAll({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    file.commit();
}

}  // namespace apertura
