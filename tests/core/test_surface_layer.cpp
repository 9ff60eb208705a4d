// Tests layers on all surfaces of the ground: levels, slopes beyond the vertical, distances in space, tiles and IDs.

#include "core/base/instance_id.hpp"
#include "core/explain/position_explainer.hpp"
#include "core/placement/compact_tile.hpp"
#include "core/placement/tile_builder.hpp"
#include "core/terrain/flat_terrain.hpp"
#include "core/terrain/nearest_position.hpp"
#include "core/terrain/triangle_parts.hpp"
#include "placement_fixture.hpp"
#include "surface_fixture.hpp"
#include "tile_fixture.hpp"

#include <doctest/doctest.h>

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <random>
#include <span>
#include <string_view>
#include <tuple>
#include <vector>

using namespace thicket;
using namespace thicket::test;

namespace {

TriangleParts::Part part_of(const surfaces::Triangles &triangles) {
	std::vector<glm::dvec3> corners;
	for (const std::uint32_t index : triangles.indices) {
		corners.push_back(triangles.vertices[index]);
	}
	auto terrain_part = std::make_shared<TriangleTerrain>();
	REQUIRE(terrain_part->set(corners, nullptr, Winding::counterclockwise).ok());
	return terrain_part;
}

TriangleParts ground_of(std::vector<TriangleParts::Part> parts) {
	TriangleParts ground;
	REQUIRE(ground.set(parts).ok());
	return ground;
}

/// Returns a level square with sides of 40 m at a height, that faces up or down.
surfaces::Triangles level(double height, bool faces_up = true) {
	const glm::dvec3 x{1, 0, 0};
	const glm::dvec3 z{0, 0, 1};
	return surfaces::square(40.0, 10, {-20, height, -20}, faces_up ? z : x, faces_up ? x : z);
}

/// Returns a wall of 40 m by 40 m that faces +x.
surfaces::Triangles wall(double x) { return surfaces::square(40.0, 10, {x, -20, -20}, {0, 1, 0}, {0, 0, 1}); }

LayerSettings layer_on_surfaces(double radius = 1.0) {
	LayerSettings layer;
	layer.set = {.seed = 3, .radius = radius, .levels = 1, .layer = 2, .on_surface = true};
	layer.rules.max_slope_degrees = 180.0;
	layer.placement.align_to_normal = 1.0;
	return layer;
}

constexpr Rect around_origin{{-32.0, -32.0}, {32.0, 32.0}};

struct Placed {
	glm::dvec3 position;
	glm::dvec3 up;
};

std::map<std::uint64_t, Placed> placed_in(const LayerSettings &layer, const Terrain &ground, const Rect &rect) {
	const TileInstances tile = built(layer, ground, rect);
	std::map<std::uint64_t, Placed> result;
	for (const MeshInstances &mesh : tile.meshes) {
		for (std::size_t i = 0; i < mesh.size(); ++i) {
			const float *floats = mesh.buffer.data() + i * mesh.stride;
			const glm::dvec3 up(floats[1], floats[5], floats[9]);
			CHECK(result.emplace(mesh.ids[i], Placed{world_position(tile, mesh, i), up}).second);
		}
	}
	return result;
}

std::size_t count_near(const std::map<std::uint64_t, Placed> &placed, double height) {
	std::size_t count = 0;
	for (const auto &[id, each] : placed) {
		count += std::abs(each.position.y - height) < 0.01 ? 1 : 0;
	}
	return count;
}

} // namespace

TEST_CASE("surface layer: every level of the ground has as many instances as it would have alone") {
	const double density = 0.547 / (3.14159265 * 0.25); // Points per square meter for a radius of 1 m.
	const TriangleParts ground = ground_of({part_of(level(0.0)), part_of(level(3.0)), part_of(level(9.0))});
	const auto placed = placed_in(layer_on_surfaces(), ground, around_origin);
	for (const double height : {0.0, 3.0, 9.0}) {
		CHECK(static_cast<double>(count_near(placed, height)) > 1600.0 * density * 0.97);
		CHECK(static_cast<double>(count_near(placed, height)) < 1600.0 * density * 1.06);
	}
	LayerSettings top = layer_on_surfaces();
	top.set.on_surface = false;
	const auto on_top = placed_in(top, ground, around_origin);
	CHECK(count_near(on_top, 9.0) == on_top.size());
}

TEST_CASE("surface layer: slopes from 0 to 180 degrees choose floors, walls and ceilings") {
	const TriangleParts ground = ground_of({part_of(level(0.0)), part_of(level(8.0, false)), part_of(wall(-5.0))});
	const auto placed_between = [&](double min, double max) {
		LayerSettings layer = layer_on_surfaces();
		layer.rules.min_slope_degrees = min;
		layer.rules.max_slope_degrees = max;
		return placed_in(layer, ground, around_origin);
	};
	const auto all = placed_between(0.0, 180.0);
	std::size_t seen_count = 0;
	CHECK(placed_between(0.0, 90.0).size() + placed_between(120.0, 180.0).size() == all.size());
	for (const auto &[min, max, up] : {std::tuple(0.0, 60.0, glm::dvec3(0, 1, 0)),
				 std::tuple(60.0, 120.0, glm::dvec3(1, 0, 0)), std::tuple(120.0, 180.0, glm::dvec3(0, -1, 0))}) {
		const auto placed_subset = placed_between(min, max);
		CHECK(placed_subset.size() > 900);
		for (const auto &[id, each] : placed_subset) {
			CHECK(glm::distance(each.up, up) < 1e-6);
			REQUIRE(all.contains(id));
			CHECK(all.at(id).position == each.position);
		}
		seen_count += placed_subset.size();
	}
	CHECK(seen_count == all.size());
}

TEST_CASE("surface layer: tiles of any size hold the same instances") {
	const TriangleParts ground =
			ground_of({part_of(level(0.0)), part_of(wall(3.3)), part_of(surfaces::sphere(17.0, 12))});
	const LayerSettings layer = layer_on_surfaces(0.8);
	const auto all_placed = placed_in(layer, ground, around_origin);
	CHECK(all_placed.size() > 4000);
	for (const double size : {16.0, 6.4}) {
		std::map<std::uint64_t, Placed> joined_parts;
		for (double z = -32.0; z < 32.0; z += size) {
			for (double x = -32.0; x < 32.0; x += size) {
				for (const auto &[id, each] : placed_in(layer, ground, {{x, z}, {x + size, z + size}})) {
					CHECK(joined_parts.emplace(id, each).second);
				}
			}
		}
		REQUIRE(joined_parts.size() == all_placed.size());
		for (const auto &[id, each] : all_placed) {
			REQUIRE(joined_parts.contains(id));
			CHECK(glm::distance(joined_parts.at(id).position, each.position) < 1e-5);
			CHECK(joined_parts.at(id).up == each.up);
		}
	}
}

TEST_CASE("surface layer: distances to other layers are measured in space") {
	const TriangleParts ground = ground_of({part_of(level(0.0)), part_of(level(4.0))});
	auto trees = std::make_shared<LayerSettings>(layer_on_surfaces(5.0));
	const auto check_spacing = [&](bool trees_on_surface, bool ferns_on_surface, bool in_space) {
		trees->set.on_surface = trees_on_surface;
		LayerSettings ferns = layer_on_surfaces();
		ferns.set.layer = 9;
		ferns.set.on_surface = ferns_on_surface;
		ferns.neighbors.push_back({.layer = trees, .distance = 2.0, .curve = nullptr});
		const auto all_trees = placed_in(*trees, ground, {{-40.0, -40.0}, {40.0, 40.0}});
		const auto placed = placed_in(ferns, ground, around_origin);
		ferns.neighbors.clear();
		const auto unspaced = placed_in(ferns, ground, around_origin);
		REQUIRE(placed.size() > 500);
		REQUIRE(placed.size() < unspaced.size());
		for (const auto &[id, fern] : unspaced) {
			double nearest = 1e9;
			for (const auto &[tree_id, tree] : all_trees) {
				const glm::dvec3 offset = fern.position - tree.position;
				nearest = std::min(nearest, glm::length(in_space ? offset : glm::dvec3(offset.x, 0.0, offset.z)));
			}
			if (std::abs(nearest - 2.0) > 1e-4) {
				CHECK(placed.contains(id) == (nearest >= 2.0));
			}
		}
	};
	check_spacing(true, true, true);
	check_spacing(false, true, true);
	check_spacing(true, false, true);
	check_spacing(false, false, false);
}

TEST_CASE("surface layer: an ID identifies the cell that contains the point, and compact tiles preserve it") {
	const TriangleParts ground = ground_of({part_of(level(-7.0)), part_of(surfaces::sphere(15.0, 12))});
	const LayerSettings layer = layer_on_surfaces(0.7);
	const TileInstances tile = built(layer, ground, around_origin);
	const auto shared = std::make_shared<const LayerSettings>(layer);
	const CompactTile compact(tile, shared);
	REQUIRE(tile.meshes.size() == 1);
	REQUIRE(tile.meshes[0].size() > 4000);
	std::vector<float> floats(tile.meshes[0].buffer.size());
	compact.meshes[0].read_all(floats);
	CHECK(std::equal(floats.begin(), floats.end(), tile.meshes[0].buffer.begin()));
	for (std::size_t i = 0; i < tile.meshes[0].size(); ++i) {
		const std::uint64_t id = tile.meshes[0].ids[i];
		CHECK(compact.meshes[0].id(i) == id);
		CHECK(unpack(id).layer == 2);
		const glm::dvec3 position = world_position(tile, tile.meshes[0], i);
		const Rect cell = cell_rect(layer.set, id);
		CHECK(cell.min.x <= position.x);
		CHECK(cell.max.x >= position.x);
		CHECK(cell.min.y <= position.z);
		CHECK(cell.max.y >= position.z);
	}
}

TEST_CASE("surface layer: ground without surfaces has no instances, and ground beyond the range of IDs is rejected") {
	CHECK(placed_in(layer_on_surfaces(), FlatTerrain(0.0f), around_origin).empty());
	TileInstances tile;
	const TriangleParts high = ground_of({part_of(level(6000.0))});
	Status status = TileBuilder().build(layer_on_surfaces(), high, around_origin, tile);
	CHECK(status.code == ErrorCode::out_of_range);
	CHECK(std::string_view(status.property) == "height of the surface");
	const TriangleParts low = ground_of({part_of(level(0.0))});
	status = TileBuilder().build(layer_on_surfaces(), low, {{40000.0, 0.0}, {40064.0, 64.0}}, tile);
	CHECK(status.code == ErrorCode::out_of_range);
	CHECK(std::string_view(status.property) == "rect");
}

TEST_CASE("surface layer: an instance that hangs is turned without a mirror image") {
	Placement placement;
	placement.align_to_normal = 1.0;
	std::mt19937 random(5);
	std::uniform_real_distribution<float> along(-1.0f, 1.0f);
	for (int i = 0; i < 2000; ++i) {
		glm::vec3 normal = i == 0 ? glm::vec3(0, -1, 0) : glm::vec3(along(random), along(random), along(random));
		normal = glm::normalize(normal);
		for (const double tilt : {0.0, 30.0}) {
			placement.min_tilt_degrees = placement.max_tilt_degrees = tilt;
			const Transform transform = transform_of(placement, static_cast<std::uint64_t>(i), normal);
			CHECK(std::abs(glm::determinant(transform.basis) - 1.0) < 1e-5);
			CHECK(std::abs(glm::dot(transform.basis[1], glm::dvec3(normal)) - std::cos(tilt * 3.14159265 / 180.0)) <
					1e-5);
		}
	}
	placement.align_to_normal = 0.5;
	CHECK(transform_of(placement, 1, {0, -1, 0}).basis[1].y < -0.8);
}

TEST_CASE("surface layer: positions on any surface are explained, and the verdict is that of the tile") {
	const TriangleParts ground = ground_of({part_of(level(0.0)), part_of(level(6.0, false)), part_of(wall(-5.0))});
	LayerSettings layer = layer_on_surfaces();
	layer.rules.min_slope_degrees = 45.0;
	layer.rules.density = 0.6;
	const auto placed = placed_in(layer, ground, around_origin);
	PositionExplainer explainer;
	PositionExplanation explanation;
	const auto explain = [&](const glm::dvec3 &position) {
		REQUIRE(explainer.find(layer, position, ground.surface()).ok());
		REQUIRE(explainer.explain({}, explanation).ok());
	};
	std::mt19937 random(9);
	std::uniform_real_distribution<double> along(-15.0, 15.0);
	for (int i = 0; i < 200; ++i) {
		const glm::dvec3 on_ceiling(along(random), 6.0, along(random));
		if (std::abs(on_ceiling.x + 5.0) < 0.4) {
			continue; // The wall is nearer.
		}
		explain(on_ceiling + glm::dvec3(0.0, -0.3, 0.0));
		CHECK(explanation.at_position.ground.height == doctest::Approx(6.0));
		CHECK(explanation.at_position.ground.normal.y == doctest::Approx(-1.0));
		CHECK(explanation.at_position.density == doctest::Approx(0.6));
		CHECK(explanation.distance < layer.set.radius);
		CHECK(explanation.is_placed() == placed.contains(explanation.point.id));
	}
	explain({3.0, 0.2, 4.0});
	CHECK(explanation.at_position.density == 0.0); // The floor is not steep enough.
	CHECK(explanation.at_position.ground.height == doctest::Approx(0.0));
	CHECK(explainer.find(layer, {3.0, 3.0, 4.0}, ground.surface()).code == ErrorCode::missing);
	CHECK(explainer.find(layer, {3.0, 0.0, 4.0}, nullptr).code == ErrorCode::missing);
	CHECK(explainer.find(layer, {3.0, std::nan(""), 4.0}, ground.surface()).code == ErrorCode::not_finite);
}

TEST_CASE("surface layer: the nearest position is on a face, an edge or a corner") {
	const auto surface = level(0.0).surface();
	CHECK(glm::distance(nearest_position(*surface, {1.3, 0.7, -2.1}, 1.0).position, {1.3, 0.0, -2.1}) < 1e-12);
	CHECK(nearest_position(*surface, {1.3, 0.7, -2.1}, 1.0).normal.y == doctest::Approx(1.0));
	CHECK(glm::distance(nearest_position(*surface, {20.5, 0.3, 3.0}, 1.0).position, {20.0, 0.0, 3.0}) < 1e-12);
	CHECK(glm::distance(nearest_position(*surface, {20.5, 0.3, 20.5}, 1.0).position, {20.0, 0.0, 20.0}) < 1e-12);
	CHECK(std::isnan(nearest_position(*surface, {0.0, 1.1, 0.0}, 1.0).position.x));
}

namespace {

/// Returns the layer of the tests below, with an edge feather of 4 m.
LayerSettings feathered() {
	LayerSettings layer = layer_on_surfaces();
	layer.rules.edge_feather = 4.0;
	return layer;
}

/// Compares a layer with the same layer without an edge feather. Checks that the feather thins the
/// layer toward an edge from which `inside` returns the distance in meters, and nowhere else.
void check_thinning(const LayerSettings &layer, const Terrain &ground, const auto &inside) {
	LayerSettings plain = layer;
	plain.rules.edge_feather = 0.0;
	const auto thinned = placed_in(layer, ground, around_origin);
	std::array<int, 3> all{}; // The counts in the outer and inner half of the feather, and beyond it.
	std::array<int, 3> kept_counts{};
	for (const auto &[id, each] : placed_in(plain, ground, around_origin)) {
		const double depth = inside(each.position);
		const std::size_t band = depth > 4.0 ? 2 : depth > 2.0 ? 1 : 0;
		++all[band];
		kept_counts[band] += thinned.contains(id) ? 1 : 0;
	}
	CHECK(all[0] > 100);
	CHECK(all[2] > 100);
	CHECK(kept_counts[2] == all[2]);
	CHECK(kept_counts[0] < 0.4 * all[0]);
	CHECK(kept_counts[1] > 0.5 * all[1]);
	CHECK(kept_counts[1] < all[1]);
}

double to_border(double a, double b) { return 20.0 - std::max(std::abs(a), std::abs(b)); }

} // namespace

TEST_CASE("surface layer: an edge feather thins toward the border of a floor, a wall and a ceiling") {
	check_thinning(
			feathered(), ground_of({part_of(level(2.0))}), [](const glm::dvec3 &at) { return to_border(at.x, at.z); });
	check_thinning(feathered(), ground_of({part_of(level(2.0, false))}),
			[](const glm::dvec3 &at) { return to_border(at.x, at.z); });
	check_thinning(
			feathered(), ground_of({part_of(wall(3.0))}), [](const glm::dvec3 &at) { return to_border(at.y, at.z); });
}

TEST_CASE("surface layer: an edge feather thins toward a region, a steep face and a limit of height") {
	LayerSettings layer = feathered();
	auto shapes = std::make_shared<ShapeSet>();
	Shape box;
	box.exclude = true;
	box.center = {3.0, 0.0, 0.0};
	box.half_size = {1.0, 5.0, 1000.0};
	REQUIRE(shapes->set({box}).ok());
	layer.rules.shapes = shapes;
	const auto to_box_or_border = [](const glm::dvec3 &at) {
		return std::min(std::abs(at.x - 3.0) - 1.0, to_border(at.x, at.z));
	};
	check_thinning(layer, ground_of({part_of(level(0.0))}), to_box_or_border);
	layer.rules.shapes = nullptr;
	layer.rules.max_height = 4.0;
	check_thinning(layer, ground_of({part_of(wall(3.0))}),
			[](const glm::dvec3 &at) { return std::min(4.0 - at.y, to_border(at.y, at.z)); });
	// A floor that meets a wall ends there.
	layer = feathered();
	layer.rules.max_slope_degrees = 45.0;
	const surfaces::Triangles half = surfaces::square(40.0, 10, {-20, 0, -20}, {0, 0, 1}, {1, 0, 0});
	check_thinning(layer,
			ground_of({part_of(half), part_of(surfaces::square(9.0, 3, {20, 0, -20}, {0, 0, 1}, {0, 1, 0}))}),
			[](const glm::dvec3 &at) { return to_border(at.x, at.z); });
}

TEST_CASE("surface layer: an edge feather leaves closed surfaces whole, and tiles have the same instances") {
	const TriangleParts ground = ground_of({part_of(surfaces::sphere(15.0, 24)), part_of(level(-8.0))});
	const LayerSettings layer = feathered();
	LayerSettings plain = layer;
	plain.rules.edge_feather = 0.0;
	const auto all_placed = placed_in(layer, ground, around_origin);
	for (const auto &[id, each] : placed_in(plain, ground, around_origin)) {
		CHECK((std::abs(each.position.y + 8.0) < 0.01 || all_placed.contains(id)));
	}
	std::size_t joined_count = 0;
	for (double z = -32.0; z < 32.0; z += 8.0) {
		for (double x = -32.0; x < 32.0; x += 8.0) {
			for (const auto &[id, each] : placed_in(layer, ground, {{x, z}, {x + 8.0, z + 8.0}})) {
				CHECK(all_placed.contains(id));
				++joined_count;
			}
		}
	}
	CHECK(joined_count == all_placed.size());
}

TEST_CASE("surface layer: an explanation contains the edge feather, and a change of the ground reaches as far") {
	const TriangleParts ground = ground_of({part_of(wall(-5.0))});
	const LayerSettings layer = feathered();
	PositionExplainer explainer;
	PositionExplanation explanation;
	const auto share_at = [&](const glm::dvec3 &position) {
		REQUIRE(explainer.find(layer, position, ground.surface()).ok());
		REQUIRE(explainer.explain({}, explanation).ok());
		const auto factor =
				std::ranges::find(explanation.at_position.factors, RuleKind::edge_feather, &RuleFactor::rule);
		REQUIRE(factor != explanation.at_position.factors.end());
		return factor->value;
	};
	CHECK(share_at({-5.0, 0.0, 0.0}) == 1.0);
	CHECK(share_at({-5.0, 18.5, 0.0}) < 1.0);
	CHECK(share_at({-5.0, 18.5, 0.0}) > 0.5);
	LayerSettings plain = layer;
	plain.rules.edge_feather = 0.0;
	CHECK(reach(layer) == doctest::Approx(reach(plain) + 4.0 * std::sqrt(2.0)));
}

namespace {

/// A density of 1 that cancels the work when it is evaluated.
class Canceling final : public DensityField {
public:
	explicit Canceling(std::atomic<bool> &cancel) : cancel_(&cancel) {}

	Status sample(std::span<const glm::dvec2> /*positions*/, std::span<float> r_density) const override {
		*cancel_ = true;
		std::ranges::fill(r_density, 1.0f);
		return {};
	}

private:
	std::atomic<bool> *cancel_;
};

} // namespace

TEST_CASE("surface layer: the search for edges can be canceled") {
	const TriangleParts ground = ground_of({part_of(level(0.0))});
	std::atomic<bool> cancel = false;
	LayerSettings layer = feathered();
	layer.rules.fields = {std::make_shared<Canceling>(cancel)};
	TileBuilder builder;
	CHECK(builder.find_points(layer, around_origin, &cancel, nullptr, ground.surface()).code == ErrorCode::cancelled);
	CHECK(builder.positions().empty());
}
