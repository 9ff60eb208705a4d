#include "nodes/drawing/instance_load.hpp"

#include "core/streaming/view_estimate.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

using namespace godot;

namespace thicket {

namespace {

/// The number of a layer's instances around a viewer above which the node gets a configuration
/// warning. That many instances use about 140 to 200 MB. For comparison, dense grass with a
/// radius of 0.2 m and a view distance of 128 m has 1.2 million. No layer of the presets or the
/// demo has more than 0.5 million.
constexpr double many_instances = 2e6;

/// Main memory per instance in bytes, as reported by get_stats(), excluding its data in the
/// renderer.
constexpr double kept_bytes = 20.0;

double expected_in_view(const LayerSnapshot &layer) {
	return expected_instances(point_density(layer.settings->set), layer.settings->rules.density, layer.range);
}

} // namespace

void InstanceLoad::measure(const TileDisplay &display, std::span<const SharedSnapshot> layers) {
	visible_fractions_.assign(layers.size(), 1.0);
	for (std::uint32_t index = 0; index < layers.size(); ++index) {
		if (layers[index] == nullptr) {
			continue;
		}
		const std::size_t tiles = display.tiles(index).size();
		const double size = layers[index]->range.tile_size;
		const double expected = expected_in_view(*layers[index]) * static_cast<double>(tiles) * size * size /
				view_area(layers[index]->range);
		if (expected > 0.0) {
			visible_fractions_[index] = std::min(static_cast<double>(display.instance_count(index)) / expected, 1.0);
		}
	}
}

void InstanceLoad::add_problems(std::span<const SharedSnapshot> layers, PackedStringArray &r_problems) const {
	for (std::size_t index = 0; index < layers.size(); ++index) {
		if (layers[index] == nullptr) {
			continue;
		}
		const LayerSnapshot &layer = *layers[index];
		const double count =
				expected_in_view(layer) * (index < visible_fractions_.size() ? visible_fractions_[index] : 1.0);
		if (count < many_instances) {
			continue;
		}
		const double bytes = 4.0 * static_cast<double>(floats_per_instance(layer.settings->instance_data)) + kept_bytes;
		const String name =
				layer.links.name.empty() ? String() : vformat(" (\"%s\")", String::utf8(layer.links.name.c_str()));
		r_problems.push_back(vformat(
				"Layer %d%s: ScatterLayer.radius and view_distance require about %.1f million instances around each "
				"viewer (%.2f per square meter, %.0f square meters), which take about %d MB. Increase radius, or "
				"lower view_distance or density. Thinning with distance draws fewer instances, but keeps "
				"all of them in memory.",
				static_cast<int64_t>(index), name, count * 1e-6, count / view_area(layer.range), view_area(layer.range),
				static_cast<int64_t>(std::ceil(count * bytes * 1e-6))));
	}
}

} // namespace thicket
