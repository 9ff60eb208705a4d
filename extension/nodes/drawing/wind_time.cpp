#include "nodes/drawing/wind_time.hpp"

#include "nodes/layer/layer_materials.hpp"

#include <godot_cpp/classes/rendering_server.hpp>
#include <godot_cpp/variant/variant.hpp>

#include <cmath>
#include <utility>

using namespace godot;

namespace thicket {

namespace {

constexpr const char *time_name = "wind_time";

/// The time wraps after this many seconds, like the engine's TIME, so that 32-bit floats in shaders
/// stay precise.
constexpr double longest_time = 3600.0;

/// The time that all nodes share.
struct SharedTime {
	double seconds = 0.0;
	std::uint64_t frame = 0; ///< The frame in which the time was last advanced.

	static SharedTime &get() {
		static SharedTime time;
		return time;
	}
};

} // namespace

void WindTime::set_layers(std::span<const SharedSnapshot> layers) {
	materials_ = materials_with(layers, time_name, Variant::FLOAT);
}

void WindTime::advance(double seconds, std::uint64_t frame) {
	SharedTime &time = SharedTime::get();
	if (std::exchange(time.frame, frame) != frame) {
		time.seconds = std::fmod(time.seconds + seconds, longest_time);
	}
	for (const Ref<Material> &material : materials_) {
		// Set the value on the RenderingServer. A value that is set on the Material would be saved
		// with it.
		RenderingServer::get_singleton()->material_set_param(material->get_rid(), time_name, time.seconds);
	}
}

} // namespace thicket
