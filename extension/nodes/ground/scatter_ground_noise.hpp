#pragma once

#include "nodes/common/guard.hpp"
#include "nodes/ground/scatter_ground.hpp"

#include <godot_cpp/classes/noise.hpp>

namespace thicket {

/// Endless hills from a Noise. Worker threads compute them from a copy of the noise, so the noise may be edited at any
/// time.
class ScatterGroundNoise : public ScatterGround {
	GDCLASS(ScatterGroundNoise, ScatterGround)
	THICKET_GUARDED_METHODS(owner)

public:
	static constexpr const char *class_name = "ScatterGroundNoise";

	/// The source of the heights; its own fractal settings determine the octaves. If null, there is no ground.
	void set_noise(const godot::Ref<godot::Noise> &p_noise);
	godot::Ref<godot::Noise> get_noise() const;

	/// The height in meters above `base_height` at a noise value of 1; 0 to 1e6. Any other value is ignored with an
	/// error.
	void set_amplitude(double p_amplitude);
	double get_amplitude() const;

	/// The world height in meters at a noise value of 0; +-1e6. Any other value is ignored with an error.
	void set_base_height(double p_height);
	double get_base_height() const;

protected:
	static void _bind_methods();
	std::shared_ptr<const Terrain> make_snapshot(const GroundHost &host) override;
	godot::String find_problem() override;

private:
	void change();

	godot::Ref<godot::Noise> noise_;
	double amplitude_ = 10.0;
	double base_height_ = 0.0;
	std::shared_ptr<const Terrain> ground_; ///< Matches the properties; null if it must be created.
};

} // namespace thicket
