// Measures the cost of a whole tile relative to its points alone. A whole tile includes sampling,
// filtering and placing into buffers that are ready for upload. The sampler alone runs on the same
// rectangles, in the same run. Prints rows of a Markdown table.
//   bench_tile [rounds = 9] [seconds a measurement = 0.25]

#include "tests/bench/common/command_line.hpp"
#include "tests/bench/common/hills.hpp"
#include "tests/bench/common/timing.hpp"

#include "core/placement/tile_builder.hpp"
#include "core/rows/row_set.hpp"
#include "core/sampling/block_cache.hpp"

#include <glm/geometric.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace thicket::bench {
namespace {

/// Returns trees as in the demo, on all ground that is not too steep or too high. They become
/// sparser toward both limits, lean slightly with the slope, and have two meshes.
LayerSettings forest(std::uint32_t levels) {
	LayerSettings layer;
	layer.set = {.seed = 1, .radius = 3.0, .levels = levels, .layer = 1};
	layer.rules = {.density = 0.9,
			.max_slope_degrees = 38.0,
			.slope_falloff_degrees = 8.0,
			.min_height = 40.0,
			.max_height = 600.0,
			.height_falloff = 80.0};
	layer.placement = {.min_scale = 0.75, .max_scale = 1.35, .align_to_normal = 0.15, .height_offset = -0.1};
	layer.mesh_weights = {3.0f, 1.0f};
	return layer;
}

/// Returns a layer that removes no point, so every point needs a transform. This is the most
/// expensive case.
LayerSettings meadow(std::uint32_t levels) {
	LayerSettings layer;
	layer.set = {.seed = 2, .radius = 3.0, .levels = levels, .layer = 2};
	layer.placement = {.min_scale = 0.75, .max_scale = 1.35, .align_to_normal = 1.0};
	return layer;
}

/// Returns plants that keep a distance from the forest's trees, which each tile must sample again.
LayerSettings spaced() {
	LayerSettings layer = meadow(1);
	layer.set.radius = 1.0;
	layer.neighbors = {{std::make_shared<LayerSettings>(forest(1)), 2.0, nullptr}};
	return layer;
}

/// Returns a species that keeps `distance` from an earlier one, whose density is `density`.
LayerSettings second_species(double earlier_radius, double density, double radius, double distance) {
	auto previous = std::make_shared<LayerSettings>(meadow(1));
	previous->set.radius = earlier_radius;
	previous->rules.density = density;
	LayerSettings layer = meadow(1);
	layer.set.layer = 3;
	layer.set.radius = radius;
	layer.neighbors = {{previous, distance, nullptr}};
	return layer;
}

/// Returns a meadow that thins toward its edge.
LayerSettings feathered() {
	LayerSettings layer = meadow(1);
	layer.rules.max_slope_degrees = 38.0;
	layer.rules.edge_feather = 8.0;
	return layer;
}

/// Returns a dense meadow below 1000 m on slopes below 30 degrees, with falloffs. The rules are
/// properties or, with the same densities, an expression.
LayerSettings ruled(bool by_expression) {
	LayerSettings layer = meadow(1);
	layer.set.radius = 1.0;
	layer.rules.max_slope_degrees = 90.0;
	if (by_expression) {
		ExpressionError error;
		layer.rules.expression = DensityExpression::compile(
				"clamp((1000 - height) / 800, 0, 1) * clamp((30 - slope) / 20, 0, 1)", error);
	} else {
		layer.rules.max_height = 1000.0;
		layer.rules.height_falloff = 800.0;
		layer.rules.max_slope_degrees = 30.0;
		layer.rules.slope_falloff_degrees = 20.0;
	}
	return layer;
}

/// Returns a dense meadow of three species. With rules, one gives way to another with the height,
/// and the third grows in patches.
LayerSettings mixed(bool by_rules) {
	LayerSettings layer = meadow(1);
	layer.set.radius = 1.0;
	layer.mesh_weights = {2.0f, 1.0f, 1.0f};
	if (by_rules) {
		for (const char *text : {"smoothstep(600, 300, height)", "smoothstep(300, 600, height)", "noise(40) > 0.6"}) {
			ExpressionError error;
			layer.mesh_rules.emplace_back(open_rules()).value().expression = DensityExpression::compile(text, error);
		}
	}
	return layer;
}

/// Returns a meadow with colors, either random or from a source at each plant.
LayerSettings colored(SourceKind kind, double max_value = 1.0) {
	LayerSettings layer = meadow(1);
	layer.set.radius = 1.0;
	layer.instance_data.use_colors = true;
	layer.instance_data.colors = std::make_shared<const ColorTable>(256, glm::vec4(0.5f));
	layer.instance_data.color.kind = kind;
	layer.instance_data.color.max = max_value;
	layer.instance_data.color.layer = std::make_shared<LayerSettings>(forest(1));
	return layer;
}

/// A walk over tiles of 64 radii. Both contenders use the same walk.
struct Walk {
	int index = 0;

	Rect next(double radius) {
		const double size = 64.0 * radius;
		constexpr int columns = 50;
		const glm::dvec2 corner = size * glm::dvec2(index % columns, index / columns % 30);
		++index;
		return {corner, corner + size};
	}
};

void compare(const std::string &name, const LayerSettings &layer, const Heightfield &hills, const Effort &effort) {
	TileSampler sampler;
	std::vector<SamplePoint> points;
	TileBuilder builder;
	TileInstances tile;
	Walk sampled, built;
	double points_seen = 0.0;
	double instances = 0.0;
	Series alone, whole;
	for (int round = 0; round < effort.rounds; ++round) {
		alone.add(rate(effort.seconds, [&] {
			require(sampler.sample(layer.set, sampled.next(layer.set.radius), points));
			return points.size();
		}));
		whole.add(rate(effort.seconds, [&] {
			require(builder.build(layer, hills, built.next(layer.set.radius), tile));
			instances += static_cast<double>(tile.counts.placed);
			points_seen += static_cast<double>(tile.counts.sampled);
			return tile.counts.sampled;
		}));
	}
	print_row(name + ": sampler alone", alone, 1e-6, " M points/s");
	print_row(name + ": whole tile", whole, 1e-6, " M points/s");
	print_row(name + ": whole tile over sampler alone", alone / whole, 1.0, " times the time");
	print_count(name + ": instances per point", instances / points_seen, "");
}

/// Generates a square of 11 x 11 tiles with empty caches, as a game does at its start, and returns
/// the number of tiles. `r_placed` is the number of instances.
int build_square(const LayerSettings &layer, const Heightfield &hills, double &r_placed) {
	constexpr int side = 11;
	TileBuilder builder({}, std::make_shared<BlockCache>(), std::make_shared<InstanceCache>());
	TileInstances tile;
	const double size = 64.0 * layer.set.radius;
	r_placed = 0.0;
	for (int i = 0; i < side * side; ++i) {
		const glm::dvec2 corner = size * glm::dvec2(i % side, i / side);
		require(builder.build(layer, hills, {corner, corner + size}, tile));
		r_placed += static_cast<double>(tile.counts.placed);
	}
	return side * side;
}

/// Compares the time for tiles of a layer that fills gaps with the time for tiles of the same layer
/// that only keeps its distance, and of the layer alone. Each tile includes the earlier layer's
/// instances that it depends on.
void compare_fill(
		const std::string &name, const LayerSettings &thinned, const Heightfield &hills, const Effort &effort) {
	LayerSettings alone = thinned;
	alone.neighbors.clear();
	LayerSettings filled = thinned;
	filled.spacing_fills = true;
	Series over_thinned, over_alone;
	double placed[3] = {};
	for (int round = 0; round < effort.rounds; ++round) {
		double rates[3] = {};
		int contender = 0;
		for (const LayerSettings *layer : {&std::as_const(alone), &thinned, &std::as_const(filled)}) {
			rates[contender] = rate(effort.seconds, [&] { return build_square(*layer, hills, placed[contender]); });
			++contender;
		}
		over_thinned.add(rates[1] / rates[2]);
		over_alone.add(rates[0] / rates[2]);
	}
	print_row(name + ": filled over thinned", over_thinned, 1.0, " times the time");
	print_row(name + ": filled over alone", over_alone, 1.0, " times the time");
	print_count(name + ": instances, filled over thinned", placed[2] / placed[1], "");
}

/// Compares the time for tiles whose rules are an expression with that for the same rules as
/// properties.
void compare_expression(const Heightfield &hills, const Effort &effort) {
	Series ratio;
	double placed[2] = {};
	for (int round = 0; round < effort.rounds; ++round) {
		double rates[2] = {};
		for (const bool by_expression : {false, true}) {
			const LayerSettings layer = ruled(by_expression);
			rates[by_expression] =
					rate(effort.seconds, [&] { return build_square(layer, hills, placed[by_expression]); });
		}
		ratio.add(rates[0] / rates[1]);
	}
	print_row("meadow by an expression over the same properties", ratio, 1.0, " times the time");
	print_count("meadow by an expression: instances over those by properties", placed[1] / placed[0], "");
}

/// Compares the time for tiles of a layer whose meshes have rules with that for plain weights.
void compare_mesh_rules(const Heightfield &hills, const Effort &effort) {
	Series ratio;
	double placed[2] = {};
	for (int round = 0; round < effort.rounds; ++round) {
		double rates[2] = {};
		for (const bool by_rules : {false, true}) {
			const LayerSettings layer = mixed(by_rules);
			rates[by_rules] = rate(effort.seconds, [&] { return build_square(layer, hills, placed[by_rules]); });
		}
		ratio.add(rates[0] / rates[1]);
	}
	print_row("meadow of three meshes with rules over plain weights", ratio, 1.0, " times the time");
}

/// Compares the time for tiles of a field in parallel rows with that for a meadow of the same density.
void compare_rows(const Heightfield &hills, const Effort &effort) {
	LayerSettings layers[] = {meadow(1), meadow(1)};
	layers[0].set.radius = 1.0;
	RowSettings settings{.step = 0.9, .fills_areas = true};
	settings.row_distance = 1.0 / (point_density(layers[0].set) * settings.step);
	auto rows = std::make_shared<RowSet>();
	const double end = 800.0;
	require(rows->set(settings,
			{{.points = {{-10.0, -10.0}, {end, -10.0}, {end, end}, {-10.0, end}}, .anchor = {400.0, 400.0}}}));
	layers[1].set.in_rows = true;
	layers[1].set.radius = equivalent_radius(settings);
	layers[1].rows = std::move(rows);
	Series ratio;
	double placed[2] = {};
	for (int round = 0; round < effort.rounds; ++round) {
		double rates[2] = {};
		for (const int in_rows : {0, 1}) {
			rates[in_rows] =
					rate(effort.seconds, [&] { return build_square(layers[in_rows], hills, placed[in_rows]); });
		}
		ratio.add(rates[0] / rates[1]);
	}
	print_row("field in rows over a meadow of the same density", ratio, 1.0, " times the time");
	print_count("field in rows: instances over those of the meadow", placed[1] / placed[0], "");
}

/// A layer of the forest preset: its radius, tile size and view distance in meters, its density, and
/// its distances to the layers before it, of which 0 means none.
struct Species {
	double radius;
	double tile_size;
	double view_distance;
	double density;
	std::vector<double> spacing;
	bool fills;
};

/// Returns the layers of the forest preset, which fill gaps as in the preset or not at all.
std::vector<std::shared_ptr<LayerSettings>> preset_layers(const std::vector<Species> &all, bool filled) {
	std::vector<std::shared_ptr<LayerSettings>> layers;
	for (const Species &species : all) {
		auto layer = std::make_shared<LayerSettings>(meadow(3));
		layer->set.radius = species.radius;
		layer->set.layer = static_cast<std::uint16_t>(layers.size() + 1);
		layer->rules.density = species.density;
		layer->rules.max_slope_degrees = 40.0;
		layer->rules.slope_falloff_degrees = 8.0;
		for (std::size_t i = 0; i < species.spacing.size(); ++i) {
			if (species.spacing[i] > 0.0) {
				layer->neighbors.push_back({layers[i], species.spacing[i], nullptr});
			}
		}
		layer->spacing_fills = filled && species.fills;
		layers.push_back(std::move(layer));
	}
	return layers;
}

/// Generates all tiles of the preset within the layers' view distances, with empty caches. Returns
/// the number of trees.
double build_view(const std::vector<Species> &all, bool filled, const Heightfield &hills) {
	const std::vector<std::shared_ptr<LayerSettings>> layers = preset_layers(all, filled);
	TileBuilder builder({}, std::make_shared<BlockCache>(), std::make_shared<InstanceCache>());
	TileInstances tile;
	double trees = 0.0;
	for (std::size_t i = 0; i < layers.size(); ++i) {
		const double size = all[i].tile_size;
		const int reach = static_cast<int>(all[i].view_distance / size) + 1;
		for (int at = 0; at < 4 * reach * reach; ++at) {
			const glm::dvec2 corner = size * glm::dvec2(at % (2 * reach) - reach, at / (2 * reach) - reach);
			if (glm::length(corner + 0.5 * size) < all[i].view_distance) {
				const glm::dvec2 first = corner + 2048.0;
				require(builder.build(*layers[i], hills, {first, first + size}, tile));
				trees += i < 3 ? static_cast<double>(tile.counts.placed) : 0.0;
			}
		}
	}
	return trees;
}

/// Compares the time for a view of the forest preset with the time for the same layers without
/// filling.
void compare_preset(const Heightfield &hills, const Effort &effort) {
	const std::vector<Species> all{{4.4, 128.0, 700.0, 0.45, {}, false}, {6.0, 128.0, 700.0, 0.85, {4.2}, true},
			{4.5, 128.0, 700.0, 0.55, {3.0, 4.2}, true}, {3.6, 64.0, 200.0, 0.25, {2.2, 1.8, 1.5}, true},
			{7.0, 64.0, 260.0, 0.5, {1.6, 1.8, 1.3, 1.6}, true},
			{16.0, 128.0, 120.0, 0.6, {2.2, 2.2, 2.2, 2.2, 2.4}, false},
			{1.15, 16.0, 90.0, 0.55, {0.8, 0.9, 0.7, 1.1, 0.9, 0.9}, false},
			{0.42, 16.0, 75.0, 1.0, {0.6, 0.6, 0.4, 0.0, 0.5, 0.5}, false}};
	Series over_thinned;
	double trees[2] = {};
	for (int round = 0; round < effort.rounds; ++round) {
		double rates[2] = {};
		for (const int filled : {0, 1}) {
			rates[filled] = rate(effort.seconds, [&] {
				trees[filled] = build_view(all, filled != 0, hills);
				return 1;
			});
		}
		over_thinned.add(rates[0] / rates[1]);
	}
	print_row("forest preset: filled over thinned", over_thinned, 1.0, " times the time");
	print_count("forest preset: trees, filled over thinned", trees[1] / trees[0], "");
}

} // namespace
} // namespace thicket::bench

int main(int argument_count, char **arguments) {
	using namespace thicket;
	using namespace thicket::bench;
	const Effort effort = effort_of(argument_count, arguments);
	const Heightfield hills = Hills::at(glm::dvec2(0.0));
	// Squares of tiles of the fill rows, and the windows around them, lie within these hills.
	const Heightfield wide_hills = Hills::at(glm::dvec2(-1000.0));
	for (const std::uint32_t levels : {1u, 4u}) {
		const std::string suffix = ", L = " + std::to_string(levels);
		compare("forest" + suffix, forest(levels), hills, effort);
		compare("meadow" + suffix, meadow(levels), hills, effort);
	}
	compare("spaced from a forest, a third of its radius", spaced(), hills, effort);
	compare_fill("species of 4 m, 4 m from one of 4 m and density 0.5", second_species(4.0, 0.5, 4.0, 4.0), wide_hills,
			effort);
	compare_fill("species of 2 m, 2 m from one of 4 m", second_species(4.0, 1.0, 2.0, 2.0), wide_hills, effort);
	compare_fill("species of 2 m, 3 m from one of 8 m", second_species(8.0, 1.0, 2.0, 3.0), wide_hills, effort);
	compare_fill("species of 4 m, 1 m from one of 2 m and density 0.5", second_species(2.0, 0.5, 4.0, 1.0), wide_hills,
			effort);
	compare_expression(wide_hills, effort);
	compare_mesh_rules(wide_hills, effort);
	compare_rows(wide_hills, effort);
	compare_preset(wide_hills, effort);
	compare("meadow with edge_feather", feathered(), hills, effort);
	compare("meadow of random colors", colored(SourceKind::random), hills, effort);
	compare("meadow of colors over slope", colored(SourceKind::slope, 45.0), hills, effort);
	compare("meadow of colors over 10 m from a forest", colored(SourceKind::distance, 10.0), hills, effort);
	compare("meadow of colors over 100 m from a forest", colored(SourceKind::distance, 100.0), hills, effort);
}
