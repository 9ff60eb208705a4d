#include "core/base/trigonometry.hpp"
#include "core/placement/mesh_choice.hpp"
#include "core/placement/placement.hpp"
#include "core/placement/rank_order.hpp"
#include "core/placement/tile_instances.hpp"
#include "placement_fixture.hpp"
#include "refusal.hpp"

#include <doctest/doctest.h>

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

using namespace thicket;
using namespace thicket::test;

namespace {

/// Returns the yaw of an upright instance, 0 to 360 degrees, as the angle of Godot's
/// Basis(Vector3.UP, angle).
double yaw_of(const Transform &transform) {
	const double yaw = std::atan2(transform.basis[2][0], transform.basis[0][0]) * 180.0 / std::numbers::pi;
	return yaw < 0.0 ? yaw + 360.0 : yaw;
}

} // namespace

TEST_CASE("placement: the rotation matches the library and is exact at quarter turns") {
	for (int i = -20000; i <= 20000; ++i) {
		const double turns = i / 10000.0;
		const Rotation rotation = rotation_by(turns);
		CHECK(std::abs(rotation.cosine - std::cos(turns * 2.0 * std::numbers::pi)) < 1e-11);
		CHECK(std::abs(rotation.sine - std::sin(turns * 2.0 * std::numbers::pi)) < 1e-11);
	}
	constexpr std::array<std::array<double, 2>, 4> quarters{{{1, 0}, {0, 1}, {-1, 0}, {0, -1}}};
	for (int quarter = -8; quarter <= 8; ++quarter) {
		const Rotation rotation = rotation_by(quarter / 4.0);
		CHECK(rotation.cosine == quarters[static_cast<std::size_t>(quarter & 3)][0]);
		CHECK(rotation.sine == quarters[static_cast<std::size_t>(quarter & 3)][1]);
	}
}

TEST_CASE("placement: a basis is a rotation times the scale, to a float's rounding") {
	std::mt19937 random(1);
	Placement placement;
	placement.min_scale = 0.25;
	placement.max_scale = 7.5;
	for (const double align : {0.0, 0.3, 1.0}) {
		placement.align_to_normal = align;
		for (int i = 0; i < 5000; ++i) {
			const glm::vec3 normal = random_normal(random);
			const Transform transform = transform_of(placement, random(), normal);
			const glm::dmat3 unit = transform.basis / double{transform.scale};
			const glm::dmat3 product = glm::transpose(unit) * unit;
			for (int column = 0; column < 3; ++column) {
				for (int row = 0; row < 3; ++row) {
					CHECK(std::abs(product[column][row] - (row == column ? 1.0 : 0.0)) < 5e-7);
				}
			}
			CHECK(glm::determinant(unit) > 0.999);
		}
	}
}

TEST_CASE("placement: the up axis is upright, along the normal, or in between") {
	std::mt19937 random(2);
	for (int i = 0; i < 1000; ++i) {
		const glm::vec3 normal = random_normal(random);
		Placement placement;
		CHECK(glm::distance(transform_of(placement, random(), normal).basis[1], glm::dvec3(up)) < 1e-6);
		placement.align_to_normal = 1.0;
		CHECK(glm::distance(transform_of(placement, random(), normal).basis[1], glm::dvec3(normal)) < 1e-6);
		placement.align_to_normal = 0.5;
		const glm::dvec3 half = glm::normalize(glm::dvec3(up) + glm::dvec3(normal));
		CHECK(glm::distance(transform_of(placement, random(), normal).basis[1], half) < 1e-6);
	}
}

TEST_CASE("placement: the tilt takes the shortest arc and adds no yaw") {
	// Without yaw, the axis of the tilt is perpendicular to the normal, and the rotation leaves it
	// unchanged.
	std::mt19937 random(3);
	Placement placement;
	placement.max_yaw_degrees = 0.0;
	placement.align_to_normal = 1.0;
	for (int i = 0; i < 1000; ++i) {
		const glm::vec3 normal = random_normal(random);
		const glm::dvec3 axis = glm::normalize(glm::cross(glm::dvec3(up), glm::dvec3(normal)));
		CHECK(glm::distance(transform_of(placement, random(), normal).basis * axis, axis) < 1e-6);
	}
}

TEST_CASE("placement: yaw is uniform over its range and positive in the engine's direction") {
	constexpr int tries = 64000;
	constexpr int bins = 32;
	std::array<int, bins> counts{};
	for (std::uint64_t id = 0; id < tries; ++id) {
		++counts[static_cast<std::size_t>(yaw_of(transform_of({}, id)) / 360.0 * bins) % bins];
	}
	// With 31 degrees of freedom, chi-squared exceeds 70 with a probability of 1 in 10,000. The IDs
	// are fixed.
	constexpr double expected = tries / double{bins};
	double chi_squared = 0.0;
	for (const int count : counts) {
		chi_squared += (count - expected) * (count - expected) / expected;
	}
	CHECK(chi_squared < 70.0);

	Placement partial;
	partial.min_yaw_degrees = 90.0;
	partial.max_yaw_degrees = 135.0;
	double lowest = 360.0;
	double highest = 0.0;
	for (std::uint64_t id = 0; id < 2000; ++id) {
		const double yaw = yaw_of(transform_of(partial, id));
		lowest = std::min(lowest, yaw);
		highest = std::max(highest, yaw);
	}
	CHECK(lowest > 89.99);
	CHECK(lowest < 90.2);
	CHECK(highest < 135.01);
	CHECK(highest > 134.8);
}

TEST_CASE("placement: scale is uniform over its range") {
	Placement placement;
	placement.min_scale = 0.5;
	placement.max_scale = 2.5;
	std::vector<double> scales;
	for (std::uint64_t id = 0; id < 20000; ++id) {
		const Transform transform = transform_of(placement, id);
		CHECK(glm::length(transform.basis[0]) == doctest::Approx(transform.scale).epsilon(1e-6));
		scales.push_back((double{transform.scale} - 0.5) / 2.0);
	}
	std::ranges::sort(scales);
	// The Kolmogorov-Smirnov statistic exceeds 2.2 / sqrt(n) with a probability below 1 in 10,000.
	double worst = 0.0;
	for (std::size_t i = 0; i < scales.size(); ++i) {
		worst = std::max(worst, std::abs(scales[i] - static_cast<double>(i) / 20000.0));
	}
	CHECK(worst < 2.2 / std::sqrt(20000.0));
	CHECK(scales.front() >= 0.0);
	CHECK(scales.back() <= 1.0);
}

TEST_CASE("placement: yaw, scale and mesh are independent of each other") {
	Placement placement;
	placement.max_scale = 2.0;
	MeshChoice choice;
	choice.set(std::vector<float>{1.0f, 1.0f});
	constexpr int tries = 20000;
	double yaw_scale = 0.0;
	double yaw_mesh = 0.0;
	double scale_mesh = 0.0;
	for (std::uint64_t id = 0; id < tries; ++id) {
		const Transform transform = transform_of(placement, id);
		// Yaw and scale are uniform in [-1, 1], and mesh is -1 or 1, so the products have a
		// variance of 1/9 or 1/3.
		const double yaw = yaw_of(transform) / 180.0 - 1.0;
		const double scale = double{transform.scale} * 2.0 - 3.0;
		const double mesh = choice.mesh_for(seed, id) == 0 ? -1.0 : 1.0;
		yaw_scale += yaw * scale;
		yaw_mesh += yaw * mesh;
		scale_mesh += scale * mesh;
	}
	CHECK(std::abs(yaw_scale) < 4.0 * std::sqrt(tries / 9.0));
	CHECK(std::abs(yaw_mesh) < 4.0 * std::sqrt(tries / 3.0));
	CHECK(std::abs(scale_mesh) < 4.0 * std::sqrt(tries / 3.0));
}

TEST_CASE("placement: changing one setting leaves all others unchanged") {
	Placement plain;
	Placement scaled = plain;
	scaled.max_scale = 3.0;
	Placement tilted = plain;
	tilted.align_to_normal = 1.0;
	const glm::vec3 position(1.5f, -2.25f, 1000.0f);
	for (std::uint64_t id = 0; id < 1000; ++id) {
		const Transform a = transform_of(plain, id, up, position);
		const Transform b = transform_of(scaled, id, up, position);
		CHECK(std::abs(yaw_of(a) - yaw_of(b)) < 1e-4);
		CHECK(std::abs(yaw_of(a) - yaw_of(transform_of(tilted, id, up, position))) < 1e-4);
		CHECK(a.position == glm::dvec3(position));
		CHECK(b.position == glm::dvec3(position));
	}
}

TEST_CASE("placement: the error for an invalid setting names the property and the value") {
	const auto refuse = [](double Placement::*member, const char *property, double value, ErrorCode code) {
		Placement bad;
		bad.*member = value;
		check_refused(validate(bad), code, property, value);
	};
	refuse(&Placement::min_yaw_degrees, "min_yaw_degrees", nan_value, ErrorCode::not_finite);
	refuse(&Placement::min_yaw_degrees, "min_yaw_degrees", -361.0, ErrorCode::out_of_range);
	refuse(&Placement::max_yaw_degrees, "max_yaw_degrees", 361.0, ErrorCode::out_of_range);
	refuse(&Placement::max_yaw_degrees, "max_yaw_degrees", -1.0, ErrorCode::inverted);
	refuse(&Placement::min_scale, "min_scale", 0.0, ErrorCode::not_positive);
	refuse(&Placement::min_scale, "min_scale", -1.0, ErrorCode::not_positive);
	refuse(&Placement::min_scale, "min_scale", infinite_value, ErrorCode::not_finite);
	refuse(&Placement::max_scale, "max_scale", 1e5, ErrorCode::out_of_range);
	refuse(&Placement::max_scale, "max_scale", 0.5, ErrorCode::inverted);
	refuse(&Placement::align_to_normal, "align_to_normal", 1.1, ErrorCode::out_of_range);
	refuse(&Placement::align_to_normal, "align_to_normal", nan_value, ErrorCode::not_finite);
	refuse(&Placement::height_offset, "height_offset", infinite_value, ErrorCode::not_finite);
	refuse(&Placement::height_offset, "height_offset", -2e4, ErrorCode::out_of_range);
	refuse(&Placement::offset_along_normal, "offset_along_normal", nan_value, ErrorCode::not_finite);
	refuse(&Placement::offset_along_normal, "offset_along_normal", 2e4, ErrorCode::out_of_range);
	refuse(&Placement::min_tilt_degrees, "min_tilt_degrees", -1.0, ErrorCode::out_of_range);
	refuse(&Placement::max_tilt_degrees, "max_tilt_degrees", 90.5, ErrorCode::out_of_range);
	refuse(&Placement::max_tilt_degrees, "max_tilt_degrees", nan_value, ErrorCode::not_finite);
	Placement inverted;
	inverted.min_tilt_degrees = 5.0;
	check_refused(validate(inverted), ErrorCode::inverted, "max_tilt_degrees", 0.0);
	CHECK(validate(Placement{}).ok());
}

TEST_CASE("placement: meshes are chosen by weight, and a mesh of weight 0 is never chosen") {
	const std::vector<float> weights{0.0f, 3.0f, 0.0f, 1.0f, 0.0f};
	MeshChoice choice;
	CHECK(choice.size() == 1);
	CHECK(choice.mesh_for(seed, 7) == 0);
	choice.set(weights);
	CHECK(choice.size() == weights.size());
	std::array<int, 5> counts{};
	for (std::uint64_t id = 0; id < 40000; ++id) {
		++counts[choice.mesh_for(seed, id << 24)];
	}
	CHECK(counts[0] + counts[2] + counts[4] == 0);
	CHECK(std::abs(counts[1] - 30000) < 4.0 * std::sqrt(40000 * 0.75 * 0.25));

	choice.set({});
	CHECK(choice.size() == 1);
}

TEST_CASE("placement: the error for invalid mesh weights contains the value") {
	const auto refuse = [](std::vector<float> weights, ErrorCode code, double value) {
		check_refused(validate_mesh_weights(weights), code, "mesh_weights", value);
	};
	refuse({1.0f, -0.5f}, ErrorCode::out_of_range, -0.5);
	refuse({1.0f, std::nanf("")}, ErrorCode::not_finite, nan_value);
	refuse({std::numeric_limits<float>::infinity()}, ErrorCode::not_finite, infinite_value);
	refuse({0.0f, 0.0f}, ErrorCode::not_positive, 0.0);
	refuse(std::vector<float>(257, 1.0f), ErrorCode::out_of_range, 257.0);
	CHECK(validate_mesh_weights({}).ok());
	CHECK(validate_mesh_weights(std::vector<float>(256, 1.0f)).ok());
	const std::vector<float> huge(3, std::numeric_limits<float>::max());
	CHECK(validate_mesh_weights(huge).ok());
}

TEST_CASE("placement: points are sorted by rank, then ID, for any input order") {
	std::mt19937_64 random(4);
	std::vector<std::uint64_t> scratch;
	for (const std::size_t count : {0u, 1u, 2u, 3u, 127u, 128u, 129u, 1000u, 50000u}) {
		for (const std::uint64_t values : {1ull, 3ull, 1ull << 20, 1ull << 32}) {
			std::vector<std::uint64_t> keys(count);
			std::vector<std::uint64_t> ids(count);
			for (std::size_t i = 0; i < count; ++i) {
				keys[i] = rank_key(static_cast<std::uint32_t>(random() % values), i);
				ids[i] = random();
			}
			std::vector<std::uint64_t> expected = keys;
			std::ranges::sort(
					expected, {}, [&](std::uint64_t key) { return std::pair(key >> 32, ids[point_of(key)]); });
			std::ranges::shuffle(keys, random);
			sort_by_rank(keys, ids, scratch);
			CHECK(keys == expected);
		}
	}
}

TEST_CASE("placement: a visible prefix contains the ranks below the density") {
	const std::vector<std::uint32_t> ranks{0, 0x3fffffff, 0x40000000, 0x80000000, 0xffffffff};
	CHECK(visible_prefix(ranks, 0.0) == 0);
	CHECK(visible_prefix(ranks, -1.0) == 0);
	CHECK(visible_prefix(ranks, nan_value) == 0);
	CHECK(visible_prefix(ranks, 1e-12) == 1);
	CHECK(visible_prefix(ranks, 0.25) == 2);
	CHECK(visible_prefix(ranks, 0.5) == 3);
	CHECK(visible_prefix(ranks, 1.0) == 5);
	CHECK(visible_prefix(ranks, infinite_value) == 5);
	CHECK(visible_prefix({}, 1.0) == 0);
}

TEST_CASE("placement: the buffer digest is computed as documented") {
	const std::vector<float> buffer{1.0f, -0.0f, 3.5f};
	std::uint64_t expected = 0xcbf29ce484222325;
	for (const float value : buffer) {
		expected = (expected ^ std::bit_cast<std::uint32_t>(value)) * 0x100000001b3;
	}
	CHECK(digest(buffer) == expected);
	CHECK(digest(std::span<const float>()) == 0xcbf29ce484222325);
}

TEST_CASE("placement: only large numbers of ranks are radix sorted, which allocates memory") {
	for (const std::size_t count : {std::size_t{100}, std::size_t{1000}}) {
		std::vector<std::uint64_t> keys;
		const std::vector<std::uint64_t> ids(count);
		for (std::size_t i = 0; i < count; ++i) {
			keys.push_back(rank_key(static_cast<std::uint32_t>(7919 * (count - i)), i));
		}
		std::vector<std::uint64_t> scratch;
		sort_by_rank(keys, ids, scratch);
		CHECK(std::ranges::is_sorted(keys));
		CHECK(scratch.size() == (count > 500 ? count : 0));
	}
}
