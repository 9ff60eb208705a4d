#include "core/placement/instance_rows.hpp"
#include "placement_fixture.hpp"
#include "tile_fixture.hpp"

#include <doctest/doctest.h>

#include <glm/gtc/quaternion.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <random>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

using namespace thicket;
using namespace thicket::test;

namespace {

using Floats = std::array<float, transform_floats>;

Floats floats_of(const glm::mat3 &basis) {
	Floats floats{};
	for (int row = 0; row < 3; ++row) {
		for (int column = 0; column < 3; ++column) {
			floats[static_cast<std::size_t>(4 * row + column)] = basis[column][row];
		}
	}
	return floats;
}

glm::mat3 put_together(const RotationAndScale &parts) {
	glm::mat3 basis = glm::mat3_cast(parts.rotation);
	for (int column = 0; column < 3; ++column) {
		basis[column] *= parts.scale[column];
	}
	return basis;
}

/// Returns the largest absolute difference between corresponding elements.
float largest_difference(const glm::mat3 &a, const glm::mat3 &b) {
	float largest = 0.0f;
	for (int column = 0; column < 3; ++column) {
		for (int row = 0; row < 3; ++row) {
			largest = std::max(largest, std::abs(a[column][row] - b[column][row]));
		}
	}
	return largest;
}

glm::quat random_rotation(std::mt19937 &random) {
	std::normal_distribution<float> along;
	return glm::normalize(glm::quat(along(random), along(random), along(random), along(random)));
}

template <class Number>
Number number_at(const std::vector<std::uint8_t> &bytes, std::size_t &r_at) {
	Number value{};
	REQUIRE(r_at + sizeof value <= bytes.size());
	std::memcpy(&value, bytes.data() + r_at, sizeof value);
	r_at += sizeof value;
	return value;
}

/// Compares a column with the expected values of the instances of all meshes.
template <class Number, class Expected>
void check_column(const std::vector<std::uint8_t> &bytes, std::size_t &r_at, const TileInstances &tile,
		const Expected &expected) {
	std::size_t wrong_count = 0;
	for (std::size_t mesh = 0; mesh < tile.meshes.size(); ++mesh) {
		for (std::size_t i = 0; i < tile.meshes[mesh].size(); ++i) {
			wrong_count +=
					number_at<Number>(bytes, r_at) == static_cast<Number>(expected(tile.meshes[mesh], i, mesh)) ? 0 : 1;
		}
	}
	CHECK(wrong_count == 0);
}

} // namespace

TEST_CASE("a transform is split into rotation and scale, for any rotation") {
	std::mt19937 random(7);
	std::uniform_real_distribution<float> size(0.1f, 4.0f);
	for (int i = 0; i < 20000; ++i) {
		glm::mat3 basis = glm::mat3_cast(random_rotation(random));
		const float sign = i % 2 == 0 ? 1.0f : -1.0f;
		basis[0] *= sign * size(random);
		basis[1] *= sign * size(random);
		basis[2] *= sign * size(random);
		const RotationAndScale parts = rotation_and_scale(floats_of(basis));
		REQUIRE(largest_difference(put_together(parts), basis) < 4e-6f);
		REQUIRE(std::abs(glm::length(parts.rotation) - 1.0f) < 1e-6f);
		REQUIRE(parts.rotation.w >= 0.0f);
		REQUIRE((parts.scale.x > 0.0f) == (sign > 0.0f));
		REQUIRE_FALSE(parts.sheared);
	}
}

TEST_CASE("half turns, whose quaternions have a single nonzero component, are correct") {
	for (const glm::quat rotation :
			{glm::quat(1, 0, 0, 0), glm::quat(0, 1, 0, 0), glm::quat(0, 0, 1, 0), glm::quat(0, 0, 0, 1)}) {
		const RotationAndScale parts = rotation_and_scale(floats_of(glm::mat3_cast(rotation) * 2.0f));
		CHECK(largest_difference(put_together(parts), glm::mat3_cast(rotation) * 2.0f) == 0.0f);
	}
}

TEST_CASE("generated instances have exactly their scale on all axes") {
	Placement placement;
	placement.min_scale = 0.3;
	placement.max_scale = 2.5;
	placement.max_tilt_degrees = 40.0;
	placement.align_to_normal = 1.0;
	std::mt19937 random(3);
	for (std::uint64_t id = 0; id < 5000; ++id) {
		Floats floats{};
		const float scale = write_transform(placement, seed, id, random_normal(random), {}, floats);
		const RotationAndScale parts = rotation_and_scale(floats);
		REQUIRE(parts.scale.x == parts.scale.y);
		REQUIRE(parts.scale.x == parts.scale.z);
		REQUIRE(parts.scale.x == doctest::Approx(scale).epsilon(1e-6));
	}
}

TEST_CASE("a shear is reported, and the rest of the transform is kept") {
	glm::mat3 basis(1.0f);
	basis[1] = {0.5f, 1.0f, 0.0f};
	const RotationAndScale parts = rotation_and_scale(floats_of(basis));
	CHECK(parts.sheared);
	CHECK(parts.rotation.w == doctest::Approx(1.0f));
	CHECK(parts.scale.x == doctest::Approx(1.0f));
	CHECK(parts.scale.y == doctest::Approx(std::sqrt(1.25f)));
}

TEST_CASE("the rows of flat instances contain only finite numbers") {
	for (const glm::mat3 &basis :
			{glm::mat3(0.0f), glm::mat3(1, 0, 0, 0, 0, 0, 0, 0, 1), glm::mat3(1, 0, 0, 1, 0, 0, 0, 0, 1)}) {
		const RotationAndScale parts = rotation_and_scale(floats_of(basis));
		CHECK(parts.rotation == glm::quat(1.0f, 0.0f, 0.0f, 0.0f));
		CHECK(std::isfinite(parts.scale.x + parts.scale.y + parts.scale.z));
	}
}

TEST_CASE("rows contain every number of a tile, column by column") {
	LayerSettings layer = rich_layer();
	layer.instance_data.use_custom_data = true;
	const TileInstances tile = built(layer, hills(), tile_of_hills);
	REQUIRE(size_of(tile) > 1000);
	std::vector<const MeshInstances *> meshes;
	for (const MeshInstances &mesh : tile.meshes) {
		meshes.push_back(&mesh);
	}
	const std::vector<std::uint8_t> bytes = instance_rows(tile.origin, meshes);
	std::size_t at = 0;
	CHECK(number_at<std::uint32_t>(bytes, at) == size_of(tile));
	CHECK(number_at<std::uint32_t>(bytes, at) == 4);
	CHECK(number_at<std::uint32_t>(bytes, at) == 0);
	CHECK(number_at<std::uint32_t>(bytes, at) == 0);
	CHECK(at == row_header_bytes);
	check_column<std::uint64_t>(
			bytes, at, tile, [](const auto &mesh, std::size_t i, std::size_t) { return mesh.ids[i]; });
	for (int axis = 0; axis < 3; ++axis) {
		check_column<double>(bytes, at, tile, [&](const auto &mesh, std::size_t i, std::size_t) {
			return tile.origin[axis] + double{mesh.buffer[i * 16 + static_cast<std::size_t>(4 * axis + 3)]};
		});
	}
	const auto parts_of = [](const MeshInstances &mesh, std::size_t i) {
		return rotation_and_scale(std::span(mesh.buffer).subspan(i * mesh.stride).first<transform_floats>());
	};
	for (const auto component : {&glm::quat::x, &glm::quat::y, &glm::quat::z, &glm::quat::w}) {
		check_column<float>(bytes, at, tile,
				[&](const auto &mesh, std::size_t i, std::size_t) { return parts_of(mesh, i).rotation.*component; });
	}
	for (int axis = 0; axis < 3; ++axis) {
		check_column<float>(bytes, at, tile,
				[&](const auto &mesh, std::size_t i, std::size_t) { return parts_of(mesh, i).scale[axis]; });
	}
	check_column<std::uint32_t>(
			bytes, at, tile, [](const auto &mesh, std::size_t i, std::size_t) { return mesh.ranks[i]; });
	for (std::size_t padding = 0; padding < 4; ++padding) {
		check_column<float>(bytes, at, tile,
				[&](const auto &mesh, std::size_t i, std::size_t) { return mesh.buffer[i * 16 + 12 + padding]; });
	}
	check_column<std::uint16_t>(bytes, at, tile, [](const auto &, std::size_t, std::size_t mesh) { return mesh; });
	CHECK(at == bytes.size());
}

TEST_CASE("the list of columns matches the rows, for each kind of instance data") {
	for (const auto &[colors, custom] : {std::pair{false, false}, {true, false}, {false, true}, {true, true}}) {
		LayerSettings layer = rich_layer();
		layer.instance_data.use_colors = colors;
		layer.instance_data.use_custom_data = custom;
		const TileInstances tile = built(layer, hills(), tile_of_hills);
		REQUIRE(size_of(tile) > 1000);
		std::size_t bytes = 0;
		std::string names;
		for (const RowColumn &column : row_columns(layer.instance_data)) {
			bytes += static_cast<std::size_t>(std::string_view(column.type).back() - '0');
			names.append(column.name).append(" ");
		}
		std::vector<const MeshInstances *> meshes;
		for (const MeshInstances &mesh : tile.meshes) {
			meshes.push_back(&mesh);
		}
		CHECK(instance_rows(tile.origin, meshes).size() == row_header_bytes + size_of(tile) * bytes);
		CHECK(names ==
				std::string("id x y z qx qy qz qw scale_x scale_y scale_z rank ") +
						(colors ? "color_r color_g color_b color_a " : "") +
						(custom ? "variation wind_phase custom_rank custom_scale " : "") + "model ");
	}
}

TEST_CASE("an empty tile has a header and no rows") {
	CHECK(instance_rows({}, {}) == std::vector<std::uint8_t>(row_header_bytes, 0));
}
