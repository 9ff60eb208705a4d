#include "core/impostor/impostor.hpp"
#include "impostor_fixture.hpp"
#include "refusal.hpp"
#include "short_of_memory.hpp"

#include <glm/geometric.hpp>

#include <cmath>
#include <numeric>

using namespace thicket;
using namespace thicket::test;

namespace {

/// Three frames on each axis of the full octahedral map. Frame (1, 1) shows the view from above,
/// (1, 2) from +z, (2, 1) from +x, and (1, 0) from -z.
constexpr ImpostorSettings three{.frames = 3, .frame_size = 64, .samples = 2, .span = OctahedralSpan::sphere};
constexpr glm::ivec2 from_above{1, 1};
constexpr glm::ivec2 from_front{1, 2};
constexpr glm::ivec2 from_right{2, 1};
constexpr glm::ivec2 from_behind{1, 0};

const glm::vec4 red{1.0F, 0.0F, 0.0F, 1.0F};
const glm::vec4 green{0.0F, 1.0F, 0.0F, 1.0F};

/// Returns the covered fraction of a frame, 0 to 1.
double coverage(const Impostor &impostor, glm::ivec2 frame) {
	const int side = impostor.settings.frame_size;
	double sum = 0.0;
	for (int y = 0; y < side; ++y) {
		for (int x = 0; x < side; ++x) {
			sum += pixel_of(impostor, impostor.albedo, frame, {x, y})[3];
		}
	}
	return sum / (255.0 * side * side);
}

/// Returns all six faces of a cube, facing outward.
ImpostorSurface cube(float half) {
	ImpostorSurface surface;
	const ImpostorSurface side = square(half, half, red);
	const std::array<glm::mat3, 6> turns{glm::mat3({1, 0, 0}, {0, 1, 0}, {0, 0, 1}),
			glm::mat3({-1, 0, 0}, {0, 1, 0}, {0, 0, -1}), glm::mat3({0, 0, -1}, {0, 1, 0}, {1, 0, 0}),
			glm::mat3({0, 0, 1}, {0, 1, 0}, {-1, 0, 0}), glm::mat3({1, 0, 0}, {0, 0, -1}, {0, 1, 0}),
			glm::mat3({1, 0, 0}, {0, 0, 1}, {0, -1, 0})};
	for (const glm::mat3 &turn : turns) {
		ImpostorSurface turned = side;
		turned.transform(turn, glm::vec3(0.0F));
		for (const std::uint32_t index : turned.indices) {
			surface.indices.push_back(index + static_cast<std::uint32_t>(surface.positions.size()));
		}
		surface.positions.insert(surface.positions.end(), turned.positions.begin(), turned.positions.end());
		surface.normals.insert(surface.normals.end(), turned.normals.begin(), turned.normals.end());
	}
	surface.material.albedo = red;
	return surface;
}

} // namespace

TEST_CASE("impostor: a known triangle, seen from its front and not from behind") {
	// The upper left half of the square from -1 to 1. Its longest edge runs from the lower left to
	// the upper right.
	const ImpostorSurface half = triangles({{-1, -1, 0}, {-1, 1, 0}, {1, 1, 0}}, red);
	const Impostor impostor = baked({half}, three);
	CHECK(impostor.min == glm::vec3(-1, -1, 0));
	CHECK(impostor.max == glm::vec3(1, 1, 0));
	CHECK(impostor.center == glm::vec3(0));
	CHECK(impostor.radius == doctest::Approx(std::sqrt(2.0)));
	// The frame is a square that is two radii wide, so its area is 8.
	CHECK(coverage(impostor, from_front) == doctest::Approx(2.0 / 8.0).epsilon(0.01));
	CHECK(coverage(impostor, from_behind) == 0.0);
	CHECK(coverage(impostor, from_right) == 0.0);
	CHECK(pixel_of(impostor, impostor.albedo, from_front, {20, 28}) == std::array{255, 0, 0, 255});
	CHECK(pixel_of(impostor, impostor.albedo, from_front, {42, 36})[3] == 0);
	CHECK(pixel_of(impostor, impostor.normal, from_front, {20, 28}) == std::array{128, 128, 255, 128});
}

TEST_CASE("impostor: a surface is drawn from both sides, or only from the back") {
	const std::vector<glm::vec3> corners{{-1, -1, 0}, {-1, 1, 0}, {1, 1, 0}};
	const Impostor two_sided = baked({triangles(corners, red, CulledSide::none)}, three);
	CHECK(coverage(two_sided, from_front) == coverage(two_sided, from_behind));
	CHECK(coverage(two_sided, from_front) > 0.24);
	// From behind, left and right are swapped, and the normal faces the viewer.
	CHECK(pixel_of(two_sided, two_sided.albedo, from_behind, {43, 28})[3] == 255);
	CHECK(pixel_of(two_sided, two_sided.normal, from_behind, {43, 28}) == std::array{128, 128, 0, 128});
	const Impostor back_side = baked({triangles(corners, red, CulledSide::front)}, three);
	CHECK(coverage(back_side, from_front) == 0.0);
	CHECK(coverage(back_side, from_behind) > 0.24);
}

TEST_CASE("impostor: each face of a cube has the right normal, depth and coverage") {
	const Impostor impostor = baked({cube(1.0F)}, three);
	const auto byte = [](double value) {
		return static_cast<int>((value * 0.5 + 0.5) * 255.0 + 0.5);
	};
	CHECK(impostor.radius == doctest::Approx(std::sqrt(3.0)));
	const int near_depth = byte(1.0 / std::sqrt(3.0));
	CHECK(pixel_of(impostor, impostor.normal, from_front, {32, 32}) == std::array{128, 128, 255, near_depth});
	CHECK(pixel_of(impostor, impostor.normal, from_behind, {32, 32}) == std::array{128, 128, 0, near_depth});
	CHECK(pixel_of(impostor, impostor.normal, from_right, {32, 32}) == std::array{255, 128, 128, near_depth});
	CHECK(pixel_of(impostor, impostor.normal, from_above, {32, 32}) == std::array{128, 255, 128, near_depth});
	for (const glm::ivec2 frame : {from_front, from_behind, from_right, from_above}) {
		CHECK(coverage(impostor, frame) == doctest::Approx(4.0 / 12.0).epsilon(0.005));
	}
	// The corner frame (2, 2) of the octahedral map is the view from below.
	CHECK(pixel_of(impostor, impostor.normal, {2, 2}, {32, 32}) == std::array{128, 0, 128, near_depth});
}

TEST_CASE("impostor: nearer surfaces hide farther ones, in any drawing order") {
	const ImpostorSurface front_square = square(1.0F, 0.5F, red);
	const ImpostorSurface back_square = square(1.0F, -0.5F, green);
	const Impostor single = baked({front_square, back_square}, three);
	const Impostor other = baked({back_square, front_square}, three);
	CHECK(single.albedo == other.albedo);
	CHECK(single.normal == other.normal);
	CHECK(pixel_of(single, single.albedo, from_front, {32, 32}) == std::array{255, 0, 0, 255});
	CHECK(pixel_of(single, single.normal, from_front, {32, 32})[3] == 170); // A depth of 0.5 m, with a radius of 1.5 m.
}

TEST_CASE("impostor: pixels with alpha below the threshold are discarded, and coverage is reduced accordingly") {
	auto texture = std::make_shared<SurfaceTexture>();
	// The left column is transparent.
	const std::vector<std::uint8_t> pixels{0, 0, 255, 0, 0, 0, 255, 255, 0, 0, 255, 0, 0, 0, 255, 255};
	REQUIRE(texture->set(2, 2, pixels).ok());
	ImpostorSurface surface = square(1.0F, 0.0F, glm::vec4(1.0F));
	surface.material.texture = texture;
	const Impostor opaque = baked({surface}, three);
	CHECK(coverage(opaque, from_front) == doctest::Approx(0.5).epsilon(0.01));
	surface.material.alpha_threshold = 0.5F;
	const Impostor clipped = baked({surface}, three);
	// The texture repeats, so alpha reaches a half at a quarter of the width and again at the right edge.
	CHECK(coverage(clipped, from_front) == doctest::Approx(0.25).epsilon(0.05));
	CHECK(pixel_of(clipped, clipped.albedo, from_front, {20, 32})[3] == 0);
	CHECK(pixel_of(clipped, clipped.albedo, from_front, {44, 32}) == std::array{0, 0, 255, 255});
	// Empty pixels take the color of their neighbors, even in empty frames.
	CHECK(pixel_of(clipped, clipped.albedo, from_front, {20, 32})[2] == 255);
	surface.material.albedo.a = 0.4F;
	CHECK(coverage(baked({surface}, three), from_front) == 0.0);
}

TEST_CASE("impostor: vertex colors are linear or in sRGB") {
	ImpostorSurface surface = square(1.0F, 0.0F, glm::vec4(1.0F));
	surface.colors.assign(4, {128.0F / 255.0F, 64.0F / 255.0F, 1.0F, 1.0F});
	const auto middle = [&](VertexColors colors) {
		surface.material.vertex_colors = colors;
		const Impostor impostor = baked({surface}, three);
		return pixel_of(impostor, impostor.albedo, from_front, {32, 32});
	};
	CHECK(middle(VertexColors::unused) == std::array{255, 255, 255, 255});
	CHECK(middle(VertexColors::linear) == std::array{188, 137, 255, 255});
	CHECK(middle(VertexColors::srgb) == std::array{128, 64, 255, 255});
	surface.colors = {{1, 0, 0, 1}, {1, 0, 0, 1}, {0, 0, 1, 1}, {0, 0, 1, 1}};
	const std::array<int, 4> mixed = middle(VertexColors::linear);
	CHECK(std::abs(mixed[0] - 188) <= 2);
	CHECK(std::abs(mixed[2] - 188) <= 2);
}

TEST_CASE("impostor: mipmaps keep the covered fraction, and frames do not bleed") {
	// Thin bars, which would vanish from mipmaps that are plain averages.
	std::vector<ImpostorSurface> bars;
	for (int at = -8; at < 8; ++at) {
		const float x = static_cast<float>(at) / 8.0F;
		bars.push_back(triangles({{x, -1, 0}, {x, 1, 0}, {x + 0.05F, 1, 0}}, red, CulledSide::none));
	}
	const Impostor impostor = baked(bars, three);
	std::size_t first = 0;
	double finest = 0.0;
	for (int side = 192; side >= 12; side /= 2) {
		std::size_t covered_count = 0;
		const auto count = static_cast<std::size_t>(side) * static_cast<std::size_t>(side);
		for (std::size_t pixel = 0; pixel < count; ++pixel) {
			covered_count += impostor.albedo[first + 4 * pixel + 3] >= 128 ? 1 : 0;
			// The only color is red, so filters must not produce any green.
			CHECK(impostor.albedo[first + 4 * pixel + 1] == 0);
		}
		const double fraction = static_cast<double>(covered_count) / static_cast<double>(count);
		finest = side == 192 ? fraction : finest;
		CHECK(finest > 0.02);
		CHECK(fraction == doctest::Approx(finest).epsilon(0.35));
		first += 4 * count;
	}
	CHECK(impostor.albedo.size() == impostor.normal.size());
}

TEST_CASE("impostor: bit-identical on every machine") {
	ImpostorSurface surface = cube(1.0F);
	surface.transform(glm::mat3({0.6F, 0.8F, 0.0F}, {-0.8F, 0.6F, 0.0F}, {0.0F, 0.0F, 1.0F}), {3.0F, 1.0F, 0.25F});
	surface.colors.assign(surface.positions.size(), {0.3F, 0.6F, 0.9F, 1.0F});
	surface.material.vertex_colors = VertexColors::srgb;
	surface.material.albedo = {0.9F, 0.8F, 0.7F, 1.0F};
	const Impostor impostor = baked({surface}, {.frames = 5, .frame_size = 32, .samples = 3});
	std::uint64_t digest = 14695981039346656037U;
	for (const auto &bytes : {impostor.albedo, impostor.normal}) {
		for (const std::uint8_t byte : bytes) {
			digest = (digest ^ byte) * 1099511628211U;
		}
	}
	CHECK(digest == 2901402152858105231U);
}

TEST_CASE("impostor: rejected input leaves the impostor unchanged") {
	Impostor impostor = baked({cube(1.0F)}, three);
	const std::vector<std::uint8_t> before = impostor.albedo;
	const std::vector<ImpostorSurface> good{cube(1.0F)};
	const auto check_rejected = [&](const std::vector<ImpostorSurface> &surfaces, const ImpostorSettings &settings,
										ErrorCode code, const char *property, double value) {
		check_refused(bake_impostor(surfaces, settings, {}, impostor), code, property, value);
		CHECK(impostor.albedo == before);
	};
	check_rejected(good, {.frames = 1}, ErrorCode::out_of_range, "frames", 1);
	check_rejected(good, {.frames = 33}, ErrorCode::out_of_range, "frames", 33);
	check_rejected(good, {.frames = 32, .frame_size = 512}, ErrorCode::out_of_range, "frames", 32);
	check_rejected(good, {.frame_size = 100}, ErrorCode::out_of_range, "frame_size", 100);
	check_rejected(good, {.frame_size = 1024}, ErrorCode::out_of_range, "frame_size", 1024);
	check_rejected(good, {.samples = 0}, ErrorCode::out_of_range, "samples", 0);
	check_rejected({}, three, ErrorCode::missing, "surfaces", 0);
	check_rejected({triangles({{1, 1, 1}, {1, 1, 1}, {1, 1, 1}}, red)}, three, ErrorCode::not_positive, "radius", 0);
	std::vector<ImpostorSurface> bad = good;
	bad[0].positions[3].y = static_cast<float>(infinite_value);
	check_rejected(bad, three, ErrorCode::not_finite, "vertices", infinite_value);
	bad = good;
	bad[0].normals.pop_back();
	check_rejected(bad, three, ErrorCode::wrong_size, "normals", 23);
	bad = good;
	bad[0].indices[5] = 24;
	check_rejected(bad, three, ErrorCode::out_of_range, "indices", 24);
	bad[0].indices.pop_back();
	check_rejected(bad, three, ErrorCode::wrong_size, "indices", 35);
	bad = good;
	bad[0].material.alpha_threshold = 1.5F;
	check_rejected(bad, three, ErrorCode::out_of_range, "alpha_threshold", 1.5);
}

TEST_CASE("impostor: progress is reported after each frame, and the cancel flag ends the call") {
	const std::vector<ImpostorSurface> surfaces{cube(1.0F)};
	std::atomic<bool> cancel = false;
	double last = 0.0;
	std::uint64_t reported = 0;
	const Progress progress{.cancel = &cancel, .report = [&](double fraction, std::uint64_t pictures) {
								CHECK(fraction > last);
								last = fraction;
								reported = pictures;
								cancel = pictures == 7;
							}};
	Impostor impostor;
	CHECK(bake_impostor(surfaces, {.frames = 4, .frame_size = 16}, progress, impostor).code == ErrorCode::cancelled);
	CHECK(reported == 7);
	CHECK(impostor.albedo.empty());
	cancel = false;
	last = 0.0;
	CHECK(bake_impostor(surfaces, {.frames = 2, .frame_size = 16}, progress, impostor).ok());
	CHECK(last == 1.0);
	CHECK(reported == 4);
}

TEST_CASE("impostor: map positions have the documented directions and frame axes") {
	for (const auto span : {OctahedralSpan::hemisphere, OctahedralSpan::sphere}) {
		for (float v = -1.0F; v <= 1.0F; v += 0.125F) {
			for (float u = -1.0F; u <= 1.0F; u += 0.125F) {
				const glm::vec3 direction = octahedral_direction({u, v}, span);
				CHECK(glm::length(direction) == doctest::Approx(1.0));
				CHECK((span == OctahedralSpan::sphere || direction.y >= 0.0F));
				const ViewAxes axes = view_axes(direction);
				CHECK(glm::dot(axes.right, axes.up) == doctest::Approx(0.0));
				CHECK(glm::dot(axes.right, direction) == doctest::Approx(0.0));
				CHECK(glm::length(axes.up) == doctest::Approx(1.0));
				CHECK(axes.up.y >= 0.0F);
				CHECK(glm::dot(glm::cross(axes.right, axes.up), direction) == doctest::Approx(1.0));
			}
		}
	}
	CHECK(octahedral_direction({0.0F, 0.0F}, OctahedralSpan::hemisphere) == glm::vec3(0, 1, 0));
	CHECK(octahedral_direction({1.0F, 1.0F}, OctahedralSpan::hemisphere) == glm::vec3(1, 0, 0));
	CHECK(octahedral_direction({1.0F, -1.0F}, OctahedralSpan::hemisphere) == glm::vec3(0, 0, 1));
	CHECK(octahedral_direction({0.0F, 1.0F}, OctahedralSpan::sphere) == glm::vec3(0, 0, 1));
}

TEST_CASE("impostor: a mirroring transform keeps front faces and outward normals") {
	ImpostorSurface surface = cube(1.0F);
	surface.transform(glm::mat3({-2.0F, 0.0F, 0.0F}, {0.0F, 1.0F, 0.0F}, {0.0F, 0.0F, 1.0F}), {10.0F, 0.0F, 0.0F});
	const Impostor impostor = baked({surface}, three);
	CHECK(impostor.center == glm::vec3(10, 0, 0));
	CHECK(coverage(impostor, from_front) > 0.3);
	CHECK(pixel_of(impostor, impostor.normal, from_right, {32, 32})[0] == 255);
	CHECK(pixel_of(impostor, impostor.normal, from_front, {32, 32})[2] == 255);
}

TEST_CASE("impostor: running out of memory leaves the impostor unchanged") {
	std::vector<ImpostorSurface> surfaces{cube(1.0F)};
	surfaces[0].colors.assign(surfaces[0].positions.size(), red);
	surfaces[0].material.vertex_colors = VertexColors::linear;
	const ImpostorSettings tiny{.frames = 2, .frame_size = 16, .samples = 1};
	const Impostor full = baked(surfaces, tiny);
	fail_every_request(
			"impostor", [] { return Impostor(); },
			[&](Impostor &r_impostor) { return bake_impostor(surfaces, tiny, {}, r_impostor); },
			[](const Impostor &impostor) { CHECK(impostor.albedo.empty()); },
			[&](const Impostor &impostor) { CHECK(impostor.albedo == full.albedo); });
}
