#pragma once

#include "nodes/common/guard.hpp"
#include "nodes/ground/scatter_ground.hpp"

#include <godot_cpp/classes/noise.hpp>

namespace thicket {

/// Endless hills of a Noise. Worked out on worker threads, from a copy of the noise, so that it may be edited at any
/// time.
class ScatterGroundNoise : public ScatterGround {
	GDCLASS(ScatterGroundNoise, ScatterGround)
	THICKET_GUARDED_METHODS(owner)

public:
	/// Where the heights come from; its own fractal settings give the octaves. Null: no ground.
	void set_noise(const godot::Ref<godot::Noise> &p_noise);
	godot::Ref<godot::Noise> get_noise() const;

	/// Meters that a noise of 1 rises above `base_height`, 0 to 1e6. Anything else prints an error and is ignored.
	void set_amplitude(double p_amplitude);
	double get_amplitude() const;

	/// World meters where the noise is 0, +-1e6. Anything else prints an error and is ignored.
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
	std::shared_ptr<const Terrain> ground_; ///< As the properties are; null if it has to be made.
};

} // namespace thicket
