#pragma once
// A floor under the whole sky: what a light gives it has a closed form.
#include "apertura/runtime/asset/asset.h"

namespace apertura::test {

inline Asset openPlane() {
    Asset asset;
    Surface plane;
    plane.positions = {{-9, 0, -9}, {9, 0, -9}, {9, 0, 9}, {-9, 0, 9}};
    plane.normals.assign(4, {0, 1, 0});
    plane.triangles = {{0, 2, 1}, {0, 3, 2}};
    asset.scene.surfaces = {plane};
    asset.scene.instances = {{0}};
    asset.seen = {{std::vector<Visibility>(4, {{0, 3.14159265f, 0}, 6.2831853f}), {}}};
    return asset;
}

}  // namespace apertura::test
