#pragma once

#include "nodes/common/guard.hpp"
#include "nodes/ground/scatter_ground.hpp"

namespace thicket {

/// An infinite horizontal plane.
class ScatterGroundFlat : public ScatterGround {
	GDCLASS(ScatterGroundFlat, ScatterGround)
	THICKET_GUARDED_METHODS(owner)

public:
	/// Sets the world height in meters, within +-1e6. Other values print an error and are ignored.
	void set_height(double p_height);
	double get_level() const;

protected:
	static void _bind_methods();
	std::shared_ptr<const Terrain> make_snapshot(const GroundHost &host) override;
	godot::String find_problem() override;

private:
	double height_ = 0.0;
};

} // namespace thicket
