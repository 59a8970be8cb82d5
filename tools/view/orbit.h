#pragma once
// A camera that goes around a point, or flies. Once moved, its picture has +Y up.
#include "apertura/runtime/asset/scene.h"

namespace apertura {

class Orbit {
public:
    // `size`: of the scene, metres: how far a step goes.
    Orbit(const Camera& home, double size) : home_(home), camera_(home), size_(size) {}

    const Camera& camera() const { return camera_; }
    void goHome() { camera_ = home_; }
    void set(const Camera& camera) { camera_ = camera; }
    // About the target, by parts of the picture's height.
    void turn(double right, double down);
    // The eye stays, and looks elsewhere.
    void look(double right, double down);
    // Eye and target together, across the picture, by parts of its height at the target.
    void pan(double right, double down);
    // Towards the target; > 0 nearer.
    void zoom(double steps);
    // Eye and target together, in the camera's own directions, in parts of the scene.
    void fly(double right, double up, double forward);

private:
    Camera home_, camera_;
    double size_;
};

}  // namespace apertura
