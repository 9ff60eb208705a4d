#pragma once

#include "nodes/common/guard.hpp"
#include "nodes/ground/scatter_ground.hpp"

#include <godot_cpp/classes/noise.hpp>

namespace thicket {

/// Infinite hills from a Noise resource. Workers use a copy, so the resource may be edited at any
/// time.
class ScatterGroundNoise : public ScatterGround {
	GDCLASS(ScatterGroundNoise, ScatterGround)
	THICKET_GUARDED_METHODS(owner)

public:
	static constexpr const char *class_name = "ScatterGroundNoise";

	/// Sets the source of the heights, including its fractal settings. If null, there is no ground.
	void set_noise(const godot::Ref<godot::Noise> &p_noise);
	godot::Ref<godot::Noise> get_noise() const;

	/// Sets the height in meters above `base_height` at a noise value of 1, from 0 to 1e6. Other
	/// values print an error and are ignored.
	void set_amplitude(double p_amplitude);
	double get_amplitude() const;

	/// Sets the world height in meters at a noise value of 0, within +-1e6. Other values print an
	/// error and are ignored.
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
	/// The ground for the current properties; null if it must be rebuilt.
	std::shared_ptr<const Terrain> ground_;
};

} // namespace thicket
