#include "core/terrain/combined_terrain.hpp"
#include "core/terrain/flat_terrain.hpp"
#include "core/terrain/heightfield.hpp"
#include "core/terrain/triangle_parts.hpp"
#include "refusal.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <memory>
#include <random>
#include <vector>

using namespace thicket;

namespace {

using Parts = std::vector<CombinedTerrain::Part>;

CombinedTerrain combined(const Parts &parts) {
	CombinedTerrain terrain;
	REQUIRE(terrain.set(parts).ok());
	return terrain;
}

bool same_bits(const Ground &a, const Ground &b) { return std::memcmp(&a, &b, sizeof(Ground)) == 0; }

/// Returns a field of random heights around `height`, in which each tenth sample is a hole.
std::shared_ptr<Heightfield> random_field(
		double height, unsigned seed, const Rect &area = {{-20.0, -20.0}, {20.0, 20.0}}) {
	std::mt19937 random(seed);
	std::vector<float> posts(21 * 21);
	for (float &post : posts) {
		post = static_cast<float>(height + 4.0 * std::uniform_real_distribution<double>(-1.0, 1.0)(random));
		post = random() % 10 == 0 ? std::nanf("") : post;
	}
	auto field = std::make_shared<Heightfield>();
	REQUIRE(field->set_meters({{21, 21}, area}, posts).ok());
	return field;
}

CombinedTerrain::Part level_square(double height, double half = 8.0) {
	const std::vector<glm::dvec3> corners{{-half, height, -half}, {half, height, -half}, {half, height, half},
			{-half, height, -half}, {half, height, half}, {-half, height, half}};
	const auto triangles = std::make_shared<TriangleTerrain>();
	REQUIRE(triangles->set(corners).ok());
	const auto parts = std::make_shared<TriangleParts>();
	const std::array<TriangleParts::Part, 1> single_part{triangles};
	REQUIRE(parts->set(single_part).ok());
	return parts;
}

std::vector<glm::dvec2> random_positions(std::size_t count, unsigned seed) {
	std::mt19937 random(seed);
	std::uniform_real_distribution<double> unit(-25.0, 25.0);
	std::vector<glm::dvec2> positions(count);
	for (glm::dvec2 &position : positions) {
		position = {unit(random), unit(random)};
	}
	positions[count / 2] = {nan_value, 0.0};
	positions[count / 3] = {0.0, infinite_value};
	return positions;
}

std::vector<Ground> query(const Terrain &terrain, const std::vector<glm::dvec2> &positions, const GroundNeeds &needs) {
	std::vector<Ground> ground(positions.size());
	REQUIRE(terrain.query(positions, needs, ground).ok());
	return ground;
}

/// Ground with the same height, normal and weight everywhere.
class Constant final : public Terrain {
public:
	explicit Constant(const Ground &ground) : ground_(ground) {}
	Status sample(std::span<const glm::dvec2>, std::span<Ground> r_ground) const override {
		for (Ground &ground : r_ground) {
			ground = {ground_.height, ground_.normal};
		}
		return {};
	}
	Status weigh(
			std::span<const glm::dvec2>, std::span<const std::int32_t>, std::span<Ground> r_ground) const override {
		for (Ground &ground : r_ground) {
			ground.weight = ground_.weight;
		}
		return {};
	}

private:
	Ground ground_;
};

class Failing final : public Terrain {
public:
	Status sample(std::span<const glm::dvec2>, std::span<Ground>) const override {
		return {ErrorCode::missing, "failing", 0.0};
	}
};

/// A surface that claims to have as many triangles as indices allow.
class Vast final : public Surface {
public:
	std::size_t triangle_count() const override { return max_triangles; }
	std::array<glm::dvec3, 3> triangle(std::uint32_t) const override { return {}; }
	const Box3 &bounds() const override { return no_box; }
	void find(const Box3 &, std::vector<std::uint32_t> &r_triangles) const override { r_triangles.clear(); }
};

class VastTerrain final : public Terrain {
public:
	Status sample(std::span<const glm::dvec2>, std::span<Ground>) const override { return {}; }
	const Surface *surface() const override { return &surface_; }

private:
	Vast surface_;
};

WeightMap channel_weights() {
	WeightMap weights;
	const std::vector<std::uint8_t> pixels{255, 51, 255, 51, 255, 51, 255, 51};
	REQUIRE(weights.set({2, 2}, 2, pixels).ok());
	return weights;
}

} // namespace

TEST_CASE("combined terrain: the highest ground is used, and no order, batch or query changes a bit") {
	Parts parts{random_field(0.0, 1), random_field(1.0, 2, {{-20.0, -5.0}, {5.0, 20.0}}), level_square(1.5),
			level_square(-1.0, 15.0)};
	const std::vector<glm::dvec2> positions = random_positions(3000, 4);
	const std::vector<Ground> expected = query(combined(parts), positions, {});
	std::size_t empty = 0;
	for (std::size_t i = 0; i < positions.size(); ++i) {
		Ground top;
		for (const CombinedTerrain::Part &part : parts) {
			const Ground ground = part->at(positions[i]);
			if (!(ground.height <= top.height) && !std::isnan(ground.height)) {
				top = ground;
			}
		}
		CHECK((same_bits(top, expected[i]) || (std::isnan(top.height) && std::isnan(expected[i].height))));
		empty += std::isnan(top.height) ? 1 : 0;
	}
	CHECK(empty > 100);
	CHECK(empty < 2000);
	for (int order = 0; order < 24; ++order) {
		std::ranges::next_permutation(parts);
		const CombinedTerrain terrain = combined(parts);
		const std::vector<Ground> ground = query(terrain, positions, {});
		CHECK(std::memcmp(ground.data(), expected.data(), sizeof(Ground) * ground.size()) == 0);
		const std::vector<Ground> heights = query(terrain, positions, {.textures = {}, .normals = false});
		const std::size_t at = 100 + static_cast<std::size_t>(order);
		const Ground alone = terrain.at(positions[at]);
		CHECK(std::memcmp(&alone, &expected[at], sizeof(Ground)) == 0);
		CHECK(std::ranges::equal(ground, heights, [](const Ground &a, const Ground &b) {
			return std::memcmp(&a.height, &b.height, sizeof(float)) == 0;
		}));
	}
}

TEST_CASE("combined terrain: at the same height, the most level normal and the largest weight are used in any order") {
	const auto constant = [](float height, glm::vec3 normal, float weight) {
		return std::make_shared<Constant>(Ground{height, normal, weight});
	};
	Parts parts{constant(2.0f, {0.6f, 0.8f, 0.0f}, 0.25f), constant(2.0f, {0.0f, 0.8f, 0.6f}, 0.75f),
			constant(2.0f, {0.6f, 0.8f, -0.0f}, 0.5f), constant(1.0f, {0.0f, 1.0f, 0.0f}, 1.0f)};
	const std::array<std::int32_t, 1> textures{0};
	for (int order = 0; order < 24; ++order) {
		std::ranges::next_permutation(parts);
		const Ground ground = query(combined(parts), {{0.0, 0.0}}, {textures, true})[0];
		CHECK(same_bits(ground, {2.0f, {0.6f, 0.8f, 0.0f}, 0.75f}));
		CHECK(query(combined(parts), {{0.0, 0.0}}, {textures, false})[0].weight == 0.75f);
	}
	for (const Parts &zeros :
			{Parts{constant(0.0f, {0.0f, 1.0f, -0.0f}, 1.0f), constant(-0.0f, {-0.0f, 1.0f, 0.0f}, 1.0f)},
					Parts{constant(-0.0f, {-0.0f, 1.0f, 0.0f}, 1.0f), constant(0.0f, {0.0f, 1.0f, -0.0f}, 1.0f)}}) {
		CHECK(same_bits(query(combined(zeros), {{0.0, 0.0}}, {})[0], {0.0f, {0.0f, 1.0f, -0.0f}, 1.0f}));
	}
}

TEST_CASE("combined terrain: the weight comes from the part that is the ground, and is 1 on a part without textures") {
	const auto lower = random_field(0.0, 1);
	lower->set_weights(channel_weights());
	const auto upper = random_field(0.5, 2);
	upper->set_weights(channel_weights());
	const CombinedTerrain terrain = combined({level_square(1.0), lower, upper, std::make_shared<FlatTerrain>(-50.0f)});
	const std::vector<glm::dvec2> positions = random_positions(2000, 7);
	const std::array<std::int32_t, 1> second{1};
	const std::array<std::int32_t, 1> other{3};
	for (const bool normals : {true, false}) {
		const std::vector<Ground> weighed = query(terrain, positions, {second, normals});
		const std::vector<Ground> without = query(terrain, positions, {other, normals});
		std::array<int, 3> counts{};
		for (std::size_t i = 0; i < positions.size(); ++i) {
			const float height = weighed[i].height;
			if (height == 1.0f || height == -50.0f) {
				CHECK(weighed[i].weight == 1.0f);
				CHECK(without[i].weight == 1.0f);
				++counts[height == 1.0f ? 0 : 1];
			} else if (!std::isnan(height)) {
				CHECK(weighed[i].weight == doctest::Approx(0.2));
				CHECK(without[i].weight == 0.0f);
				++counts[2];
			}
		}
		CHECK(*std::ranges::min_element(counts) > 20);
	}
}

TEST_CASE("combined terrain: the surfaces of all parts give the same triangles in any order") {
	const CombinedTerrain::Part bridge = level_square(6.0);
	const CombinedTerrain::Part field = random_field(0.0, 1);
	const CombinedTerrain::Part flat = std::make_shared<FlatTerrain>(2.0f);
	const CombinedTerrain terrain = combined({flat, bridge, field, bridge});
	REQUIRE(terrain.surface() != nullptr);
	CHECK(terrain.surface()->triangle_count() ==
			bridge->surface()->triangle_count() + field->surface()->triangle_count());
	CHECK(terrain.surface()->area() == doctest::Approx(bridge->surface()->area() + field->surface()->area()));
	const CombinedTerrain swapped = combined({field, bridge});
	for (std::uint32_t index = 0; index < terrain.surface()->triangle_count(); ++index) {
		CHECK(terrain.surface()->triangle(index) == swapped.surface()->triangle(index));
	}
	CHECK(combined({flat}).surface() == nullptr);
}

TEST_CASE("combined terrain: surfaces with the same bounds are in an order that depends on their triangles") {
	const auto half = [](bool other) {
		std::vector<glm::dvec3> vertices{{0, 0, 0}, {0, 0, 1}, {1, 1, 0}, {1, 1, 1}};
		std::shared_ptr<const Surface> result;
		REQUIRE(Surface::create(
				vertices, other ? std::vector<std::uint32_t>{0, 1, 3} : std::vector<std::uint32_t>{0, 3, 2}, result)
						.ok());
		return result;
	};
	const std::vector<Surface::Part> parts{half(false), half(true), half(false)};
	const auto joined_surface = Surface::of_parts(parts);
	const auto reversed = Surface::of_parts(std::vector<Surface::Part>{parts[2], parts[1], parts[0]});
	for (std::uint32_t index = 0; index < 3; ++index) {
		CHECK(joined_surface->triangle(index) == reversed->triangle(index));
	}
}

TEST_CASE("combined terrain: more triangles than indices are rejected without a change") {
	CombinedTerrain terrain = combined({std::make_shared<FlatTerrain>(3.0f)});
	const Parts parts{std::make_shared<VastTerrain>(), level_square(1.0)};
	CHECK(terrain.set(parts).code == ErrorCode::out_of_range);
	CHECK(terrain.at({0.0, 0.0}).height == 3.0f);
	CHECK(combined({parts[0]}).surface() != nullptr);
}

TEST_CASE("combined terrain: without parts there is no ground; failures and wrong sizes are passed on") {
	CHECK(std::isnan(CombinedTerrain().at({0.0, 0.0}).height));
	CHECK(CombinedTerrain().surface() == nullptr);
	const CombinedTerrain terrain = combined({std::make_shared<FlatTerrain>(1.0f), std::make_shared<Failing>()});
	std::vector<Ground> ground(300);
	const std::vector<glm::dvec2> positions(300);
	const std::array<std::int32_t, 1> textures{0};
	check_refused(terrain.sample(positions, ground), ErrorCode::missing, "failing", 0.0);
	check_refused(terrain.sample_heights(positions, ground), ErrorCode::missing, "failing", 0.0);
	check_refused(terrain.weigh(positions, textures, ground), ErrorCode::missing, "failing", 0.0);
	ground.resize(2);
	check_refused(terrain.sample(positions, ground), ErrorCode::wrong_size, "ground", 2.0);
	check_refused(terrain.sample_heights(positions, ground), ErrorCode::wrong_size, "ground", 2.0);
	check_refused(terrain.weigh(positions, textures, ground), ErrorCode::wrong_size, "ground", 2.0);
}
