#include "nodes/ground/scatter_ground_noise.hpp"

#include "core/terrain/slope_stencil.hpp"
#include "nodes/common/property_check.hpp"
#include "nodes/common/watch.hpp"

#include <godot_cpp/core/class_db.hpp>

#include <array>
#include <cmath>

using namespace godot;

namespace thicket {

namespace {

/// Ground from a private copy of a Noise resource. Sampling does not modify the copy, so any thread
/// may use it.
class NoiseGround : public Terrain {
public:
	NoiseGround(const Ref<Noise> &p_noise, double p_amplitude, double p_base) :
			noise_(p_noise), amplitude_(p_amplitude), base_(p_base) {}

	Status sample(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const override {
		if (positions.size() != r_ground.size()) {
			return Status::wrong_size("ground", r_ground.size(), exactly(positions.size()));
		}
		for (std::size_t i = 0; i < positions.size(); ++i) {
			r_ground[i] = ground_at(positions[i]);
		}
		return {};
	}

	/// Samples heights only. Computing a normal would take four more noise calls, which dominate
	/// the cost.
	Status sample_heights(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const override {
		if (positions.size() != r_ground.size()) {
			return Status::wrong_size("ground", r_ground.size(), exactly(positions.size()));
		}
		for (std::size_t i = 0; i < positions.size(); ++i) {
			// The same height as in `sample`.
			r_ground[i].height = height_at(positions[i]);
		}
		return {};
	}

private:
	float height_at(glm::dvec2 position) const {
		const glm::dvec2 center(static_cast<float>(position.x), static_cast<float>(position.y));
		return std::isfinite(center.x) && std::isfinite(center.y) ? static_cast<float>(base_ + rise_at(center))
																  : Ground{}.height;
	}

	/// Returns the height above the base in meters.
	double rise_at(glm::dvec2 position) const {
		return amplitude_ * noise_->get_noise_2d(static_cast<float>(position.x), static_cast<float>(position.y));
	}

	Ground ground_at(glm::dvec2 position) const {
		const SlopeStencil stencil(position);
		if (!std::isfinite(stencil.center().x) || !std::isfinite(stencil.center().y)) {
			return {};
		}
		std::array<float, 4> neighbor_rises{};
		for (std::size_t i = 0; i < neighbor_rises.size(); ++i) {
			neighbor_rises[i] = static_cast<float>(rise_at(stencil.positions()[i]));
		}
		const double rise = rise_at(stencil.center());
		return {static_cast<float>(base_ + rise), stencil.normal(static_cast<float>(rise), neighbor_rises)};
	}

	Ref<Noise> noise_;
	double amplitude_;
	double base_;
};

} // namespace

std::shared_ptr<const Terrain> ScatterGroundNoise::make_snapshot(const GroundHost &) {
	if (ground_ != nullptr) {
		// The ground is still up to date.
		return ground_;
	}
	if (noise_.is_valid()) {
		ground_ = std::make_shared<NoiseGround>(Ref<Noise>(noise_->duplicate(true)), amplitude_, base_height_);
	}
	return ground_;
}

String ScatterGroundNoise::find_problem() {
	return noise_.is_valid() ? String() : "ScatterGroundNoise.noise is missing: set it to a FastNoiseLite.";
}

void ScatterGroundNoise::change() {
	ground_ = nullptr;
	emit_changed();
}

void ScatterGroundNoise::set_noise(const Ref<Noise> &p_noise) {
	if (noise_ != p_noise) {
		watch(noise_.ptr(), "changed", this, "_change", false);
		noise_ = p_noise;
		watch(noise_.ptr(), "changed", this, "_change", true);
		change();
	}
}

Ref<Noise> ScatterGroundNoise::get_noise() const { return noise_; }

void ScatterGroundNoise::set_amplitude(double p_amplitude) {
	if (accept_number(class_name, "amplitude", p_amplitude, 0.0, height_limit)) {
		amplitude_ = p_amplitude;
		change();
	}
}

double ScatterGroundNoise::get_amplitude() const { return amplitude_; }

void ScatterGroundNoise::set_base_height(double p_height) {
	if (accept_number(class_name, "base_height", p_height, -height_limit, height_limit)) {
		base_height_ = p_height;
		change();
	}
}

double ScatterGroundNoise::get_base_height() const { return base_height_; }

void ScatterGroundNoise::_bind_methods() {
	using Self = ScatterGroundNoise;
	bind_guarded<&Self::set_noise>(D_METHOD("set_noise", "noise"));
	bind_guarded<&Self::get_noise>(D_METHOD("get_noise"));
	bind_guarded<&Self::set_amplitude>(D_METHOD("set_amplitude", "amplitude"));
	bind_guarded<&Self::get_amplitude>(D_METHOD("get_amplitude"));
	bind_guarded<&Self::set_base_height>(D_METHOD("set_base_height", "height"));
	bind_guarded<&Self::get_base_height>(D_METHOD("get_base_height"));
	bind_guarded<&Self::change>(ThreadUse::relayed, D_METHOD("_change"));
	ADD_PROPERTY(
			PropertyInfo(Variant::OBJECT, "noise", PROPERTY_HINT_RESOURCE_TYPE, "Noise"), "set_noise", "get_noise");
	ADD_PROPERTY(PropertyInfo(Variant::FLOAT, "amplitude", PROPERTY_HINT_RANGE, "0,500,0.01,or_greater,suffix:m"),
			"set_amplitude", "get_amplitude");
	ADD_PROPERTY(PropertyInfo(Variant::FLOAT, "base_height", PROPERTY_HINT_RANGE,
						 "-1000,9000,0.01,or_less,or_greater,suffix:m"),
			"set_base_height", "get_base_height");
}

} // namespace thicket
