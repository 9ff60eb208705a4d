#pragma once

// The layers of the tiles that have golden digests.

#include "tests/analysis/curve_table.hpp"

#include "core/placement/layer.hpp"
#include "core/rules/image_mask.hpp"

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

namespace thicket::analysis {

inline LayerSettings forest() {
	LayerSettings layer;
	layer.set = {.seed = 8, .radius = 2.5, .levels = 3, .layer = 4};
	layer.rules.density = 0.8;
	layer.rules.min_slope_degrees = 2.0;
	layer.rules.max_slope_degrees = 40.0;
	layer.rules.slope_falloff_degrees = 10.0;
	layer.rules.min_height = 150.0;
	layer.rules.max_height = 700.0;
	layer.rules.height_falloff = 100.0;
	layer.placement.min_yaw_degrees = -170.0;
	layer.placement.max_yaw_degrees = 180.0;
	layer.placement.min_scale = 0.7;
	layer.placement.max_scale = 1.6;
	layer.placement.align_to_normal = 0.6;
	layer.placement.height_offset = -0.2;
	layer.mesh_weights = {3.0f, 1.0f, 0.5f};
	return layer;
}

/// Returns an avenue along a bent line that crosses itself, for a 200 m tile at `corner`, or a field of
/// parallel rows inside this line.
inline LayerSettings in_rows(glm::dvec2 corner, bool fills_area) {
	LayerSettings layer;
	layer.placement.min_yaw_degrees = -15.0;
	layer.placement.max_yaw_degrees = 15.0;
	layer.placement.align_to_normal = 0.5;
	RowSettings settings{.step = 2.5, .offsets = {-3.0, 4.5}, .jitter_along = 0.3, .jitter_across = 0.4};
	settings.fills_areas = fills_area;
	settings.row_distance = 1.7;
	settings.row_angle_degrees = 25.0;
	settings.crossing_gap = 9.0;
	RowLine line{.identity = 0x0123456789abcdef};
	line.anchor = corner + 17.0;
	for (const glm::dvec2 point :
			{glm::dvec2(-20.0, 30.0), {150.0, 40.0}, {190.0, 120.0}, {90.0, 190.0}, {60.0, -10.0}}) {
		line.points.push_back(corner + point);
	}
	auto rows = std::make_shared<RowSet>();
	expect(rows->set(settings, {line}));
	layer.rows = rows;
	layer.set = {.seed = 8, .radius = equivalent_radius(settings), .levels = 1, .layer = 9, .in_rows = true};
	return layer;
}

/// Returns a layer that uses all kinds of rules and density fields except biomes, water and ground
/// textures, for a 200 m tile at `corner`.
inline LayerSettings undergrowth(glm::dvec2 corner) {
	auto shrubs = std::make_shared<LayerSettings>();
	shrubs->set = {.seed = 8, .radius = 4.0, .levels = 1, .layer = 5};
	shrubs->rules.density = 0.7;
	shrubs->neighbors = {{std::make_shared<LayerSettings>(forest()), 3.0, nullptr}};

	LayerSettings layer = forest();
	layer.set = {.seed = 8, .radius = 1.0, .levels = 2, .layer = 6};
	layer.rules.density = 1.0;
	layer.rules.height_curve = curve_table(100.0, 800.0, {0.5f, 1.0f, 0.25f});
	layer.rules.slope_curve = curve_table(0.0, 45.0, {1.0f, 0.75f, 0.5f});
	layer.rules.clumping = {15.0, 0.6, 0.3};
	layer.rules.edge_feather = 4.0;
	layer.neighbors = {{shrubs, 5.0, curve_table(0.0, 5.0, {1.0f, 0.4f})}, {shrubs, 0.75, nullptr}};

	auto mask = std::make_shared<PaintedMask>();
	Rect changed_rect;
	expect(mask->reset(0.75, 1.0));
	expect(mask->paint({Brush::Mode::erase, corner + glm::dvec2(60.0, 140.0), 30.0, 0.9, 0.3}, changed_rect));
	expect(mask->paint({Brush::Mode::smooth, corner + glm::dvec2(80.0, 120.0), 25.0, 0.8, 0.5}, changed_rect));
	layer.rules.mask = mask;
	auto image = std::make_shared<ImageMask>();
	const std::array<std::uint8_t, 6> pixels{255, 160, 220, 90, 255, 200};
	expect(image->set({3, 2}, pixels, {corner - 10.0, corner + 90.0}, MaskEdge::repeat));
	layer.rules.fields = {image};
	Shape path;
	path.kind = ShapeKind::path;
	path.exclude = true;
	path.falloff = 1.5;
	path.half_size = {3.0, 0.0, 0.0};
	path.outline = {corner, corner + glm::dvec2(70.0, 90.0), corner + glm::dvec2(200.0, 110.0)};
	auto shapes = std::make_shared<ShapeSet>();
	expect(shapes->set({path}));
	layer.rules.shapes = shapes;

	layer.placement.max_tilt_degrees = 12.0;
	layer.placement.offset_along_normal = 0.1;
	layer.placement.scale_curve = curve_table(0.0, 1.0, {0.0f, 0.2f, 1.0f});
	layer.instance_data.use_colors = true;
	layer.instance_data.colors =
			std::make_shared<ColorTable>(ColorTable{{0.1f, 0.6f, 0.2f, 1.0f}, {0.7f, 0.6f, 0.1f, 1.0f}});
	layer.instance_data.use_custom_data = true;
	return layer;
}

/// Returns a forest in which one species gives way to another with the height, and a third one grows
/// in clumps on gentle slopes.
inline LayerSettings mixed_forest() {
	LayerSettings layer = forest();
	Rules low = open_rules();
	low.max_height = 500.0;
	low.height_falloff = 250.0;
	ExpressionError error;
	Rules high = open_rules();
	high.expression = DensityExpression::compile("smoothstep(250, 500, height) * lerp(0.4, 1, noise(30))", error);
	Rules clumps = open_rules();
	clumps.clumping = {20.0, 0.4, 0.5};
	clumps.max_slope_degrees = 25.0;
	clumps.slope_falloff_degrees = 15.0;
	layer.mesh_rules = {low, high, clumps};
	return layer;
}

/// Returns a layer of ferns that fills the gaps between shrubs, which fill the gaps in the forest.
inline LayerSettings filling_ferns() {
	auto shrubs = std::make_shared<LayerSettings>();
	shrubs->set = {.seed = 8, .radius = 2.0, .levels = 3, .layer = 5};
	shrubs->rules.density = 0.6;
	shrubs->neighbors = {{std::make_shared<LayerSettings>(forest()), 2.5, nullptr}};
	shrubs->spacing_fills = true;

	LayerSettings layer = forest();
	layer.set = {.seed = 8, .radius = 1.0, .levels = 2, .layer = 6};
	layer.neighbors = {{shrubs, 0.9, nullptr}, {shrubs->neighbors[0].layer, 1.1, nullptr}};
	layer.spacing_fills = true;
	return layer;
}

} // namespace thicket::analysis
