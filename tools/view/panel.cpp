// The viewer's widgets.
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tools/view/viewer.h"

namespace apertura {
namespace {

bool slide(const char* label, double& value, double least, double most, const char* format = "%.1f", ImGuiSliderFlags flags = 0) {
    auto number = float(value);
    if (!ImGui::SliderFloat(label, &number, float(least), float(most), format, flags)) return false;
    value = double(number);
    return true;
}

ImU32 grey(float share) { return ImGui::GetColorU32(ImVec4(share, share, share, 1)); }

// A hemisphere as a disc, its normal in the middle. `value`: of a cell, 0..1, or < 0 beside the disc.
template <typename Value>
void disc(const char* label, const Value& value) {
    constexpr int kCells = ProbeResult::kCells;
    constexpr float kCell = 3;
    const ImVec2 corner = ImGui::GetCursorScreenPos();
    ImDrawList& list = *ImGui::GetWindowDrawList();
    for (int y = 0; y < kCells; ++y)
        for (int x = 0; x < kCells; ++x)
            if (const float share = value(size_t(y) * kCells + size_t(x)); share >= 0) {
                const ImVec2 at(corner.x + kCell * float(x), corner.y + kCell * float(y));
                list.AddRectFilled(at, ImVec2(at.x + kCell, at.y + kCell), grey(share * share));
            }
    ImGui::Dummy(ImVec2(kCell * kCells, kCell * kCells));
    ImGui::TextUnformatted(label);
}

}  // namespace

void Viewer::panelLights() {
    if (!ImGui::CollapsingHeader("Light", ImGuiTreeNodeFlags_DefaultOpen)) return;
    ViewOptions& o = settings.light;
    bool sun = !o.noSun, toned = o.tone == "neutral";
    if (ImGui::Checkbox("sun", &sun)) o.noSun = !sun;
    ImGui::SameLine();
    ImGui::Checkbox("a day plays (space)", &settings.plays);
    slide("azimuth", o.azimuth, 0, 360);
    slide("elevation", o.elevation, -10, 90);
    slide("radius", o.radius, 0.05, 45, "%.2f", ImGuiSliderFlags_Logarithmic);
    slide("exposure", o.exposure, -8, 8, "%.1f EV");
    if (ImGui::Checkbox("neutral tone", &toned)) o.tone = toned ? "neutral" : "";
    ImGui::SameLine();
    ImGui::Checkbox("plain", &o.plain);
    if (bool bounces = o.bounces > 0; ImGui::Checkbox("light bounces (r)", &bounces)) o.bounces = bounces ? kBounces : 0;
    for (size_t i = 0; i < base_.lights.size(); ++i)
        if (AperturaLight& light = base_.lights[i]; aperturaIsSphere(light)) {
            ImGui::PushID(int(i));
            lampsMoved_ |= ImGui::DragFloat3("lamp", &light.sphere.x, 0.02f);
            ImGui::PopID();
        }
}

void Viewer::panelModels() {
    if (!ImGui::CollapsingHeader("Models", ImGuiTreeNodeFlags_DefaultOpen)) return;
    const char* const labels[] = {"left", "right"};
    for (size_t picture = 0; picture < 2; ++picture) {
        if (picture == 1 && (!settings.split || settings.truth)) continue;
        const Model* const now = settings.models[picture];
        if (!ImGui::BeginCombo(settings.split ? labels[picture] : "model", now ? std::string(now->name).c_str() : "shadow-map")) continue;
        for (const std::string& name : modelNames()) {
            const Model* const model = findModel(name);
            char line[128];
            if (model)
                std::snprintf(line, sizeof line, "%-14s %3d numbers %4d cycles", name.c_str(), model->numbers, model->cycles);
            else
                std::snprintf(line, sizeof line, "%-14s", name.c_str());
            if (ImGui::Selectable(line, model == now)) settings.models[picture] = model;
        }
        ImGui::EndCombo();
    }
    const View view = currentView();
    if (!preparer_->isReady(wantedFor(settings.models[0], view), view)) ImGui::TextUnformatted("made ready ...");
    if (!settings.models[0] && view.lights.size() != 1) ImGui::TextUnformatted("a shadow map is drawn of the sun alone");
    if (settings.models[0]) ImGui::TextWrapped("%s", std::string(settings.models[0]->what).c_str());
    ImGui::Text("%.3g bytes a point, %.4g KiB in all", bytesAPoint(asset_), double(visibilityBytes(asset_)) / 1024);
    ImGui::Checkbox("split (tab)", &settings.split);
    ImGui::SameLine();
    if (ImGui::Checkbox("truth (t)", &settings.truth)) settings.split = settings.truth;
    ImGui::SameLine();
    if (ImGui::Checkbox("difference (x)", &settings.heat)) settings.split = settings.split || settings.heat;
    if (settings.heat) ImGui::TextUnformatted("red: the left is too bright, blue: too dark");
}

void Viewer::panelTruth() {
    if (!settings.truth) return;
    if (!truth) {
        ImGui::TextUnformatted(tracer_->tracer() ? "truth waits for the picture to rest" : "made ready for rays ...");
    } else if (truth->difference < 0) {
        ImGui::TextUnformatted("truth: a preview");
    } else {
        ImGui::Text("off by %.2f %% of its mean radiance, RMS", 100 * truth->difference);
        if (truth->passes > 1) ImGui::Text("its own noise %.2f %%", 100 * truth->noise);
        ImGui::Text("after pass %d %s", truth->passes, truth->isConverged ? "converged" : "not converged yet");
    }
}

void Viewer::panelCost() {
    if (!ImGui::CollapsingHeader("Cost", ImGuiTreeNodeFlags_DefaultOpen)) return;
    ImGui::TextWrapped("%s, %u x %u", window_.gpu().name().c_str(), window_.size().width, window_.size().height);
    if (!times_.empty()) {
        std::vector<float> all;
        for (const Times& t : times_) all.push_back(float(1e3 * (t.draw + t.compose)));
        ImGui::Text("scene %.2f ms, shown %.2f ms, while it moves", 1e3 * times_.back().draw, 1e3 * times_.back().compose);
        ImGui::PlotLines("ms", all.data(), int(all.size()), 0, nullptr, 0, FLT_MAX, ImVec2(0, 40));
    }
    ImGui::Text("%.1f MiB on the device", double(window_.gpu().counters().allocatedBytes) / 0x1p20);
}

void Viewer::panel() {
    const ImGuiIO& io = ImGui::GetIO();
    if (settings.split) {
        const float x = float(settings.splitAt) * io.DisplaySize.x;
        ImGui::GetBackgroundDrawList()->AddLine(ImVec2(x, 0), ImVec2(x, io.DisplaySize.y), IM_COL32(255, 255, 255, 160), 2);
    }
    if (probed_) {
        // The soft opening's rim would be a blur: its axis and the cap of the same area are drawn.
        const View view = currentView();
        const glm::mat4 toClip = clipTransform(view.camera, double(view.width) / view.height, 1e-4);
        const auto onScreen = [&](const glm::vec3& p, ImVec2& out) {
            const glm::vec4 c = toClip * glm::vec4(p, 1);
            out = ImVec2((c.x / c.w * 0.5f + 0.5f) * io.DisplaySize.x, (c.y / c.w * 0.5f + 0.5f) * io.DisplaySize.y);
            return c.w > 0;
        };
        const float length = glm::length(probed_->visibility.direction);
        const float reach = 0.15f * glm::distance(view.camera.eye, probed_->position);
        ImVec2 foot, before, next;
        if (length > 0 && onScreen(probed_->position, foot)) {
            const AperturaAperture cap = aperturaMakeAperture(
                probed_->visibility.direction / length, std::clamp(probed_->visibility.area / (2 * std::numbers::pi_v<float>), 0.0f, 1.0f));
            const glm::vec3 right = aperturaTangentTo(cap.axis), up = glm::cross(cap.axis, right);
            const float cosine = 1 - cap.height, sine = std::sqrt(std::max(1 - cosine * cosine, 0.0f));
            constexpr int kSteps = 48;
            bool seen = false;
            for (int i = 0; i <= kSteps; ++i) {
                const float turn = 2 * std::numbers::pi_v<float> * float(i) / kSteps;
                const glm::vec3 rim = cosine * cap.axis + sine * (std::cos(turn) * right + std::sin(turn) * up);
                const bool now = onScreen(probed_->position + reach * rim, next);
                if (now && seen) ImGui::GetBackgroundDrawList()->AddLine(before, next, IM_COL32(255, 220, 80, 255), 2);
                if (now && i % 8 == 0) ImGui::GetBackgroundDrawList()->AddLine(foot, next, IM_COL32(255, 220, 80, 160), 1);
                before = next, seen = now;
            }
        }
    }
    if (!message_.empty() && std::chrono::steady_clock::now() < messageUntil_) {
        ImGui::SetNextWindowPos(ImVec2(io.DisplaySize.x / 2, io.DisplaySize.y - 40), ImGuiCond_Always, ImVec2(0.5f, 1));
        ImGui::Begin("message", nullptr, ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoInputs);
        ImGui::TextUnformatted(message_.c_str());
        ImGui::End();
    }
    if (!settings.panel) return;
    ImGui::SetNextWindowPos(ImVec2(8, 8), ImGuiCond_FirstUseEver);
    ImGui::SetNextWindowSize(ImVec2(330, 0), ImGuiCond_FirstUseEver);
    ImGui::Begin("apertura (F1)", nullptr, ImGuiWindowFlags_AlwaysAutoResize);
    panelLights();
    panelModels();
    panelTruth();
    panelCost();
    if (ImGui::CollapsingHeader("Keys")) {
        ImGui::TextUnformatted(kViewerKeys);
    }
    if (probed_ && ImGui::CollapsingHeader("Probe", ImGuiTreeNodeFlags_DefaultOpen)) {
        const Visibility& v = probed_->visibility;
        ImGui::Text("D %.3f %.3f %.3f, A %.3f sr", double(v.direction.x), double(v.direction.y), double(v.direction.z), double(v.area));
        ImGui::BeginGroup();
        disc("traced", [&](size_t i) { return probed_->traced[i] < 0 ? -1.0f : float(probed_->traced[i]); });
        ImGui::EndGroup();
        ImGui::SameLine();
        ImGui::BeginGroup();
        disc("the left model", [&](size_t i) { return probed_->shown[i]; });
        ImGui::EndGroup();
        ImGui::Text("E now, traced: %.4f W/m2", probed_->truth);
        for (const ProbeResult::OfModel& m : probed_->models) ImGui::Text("%-14s %.4f", m.name.c_str(), m.irradiance);
    }
    ImGui::End();
}

}  // namespace apertura
