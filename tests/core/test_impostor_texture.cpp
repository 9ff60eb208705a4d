#include "core/impostor/srgb.hpp"
#include "core/impostor/surface_texture.hpp"
#include "refusal.hpp"

#include <cmath>
#include <vector>

using namespace thicket;

TEST_CASE("impostor texture: the sRGB curve is accurate to 1e-6, and bytes convert back exactly") {
	const SrgbCurve &curve = SrgbCurve::get();
	for (int stored = 0; stored < 256; ++stored) {
		const double unit = stored / 255.0;
		const double exact = unit <= 0.04045 ? unit / 12.92 : std::pow((unit + 0.055) / 1.055, 2.4);
		const auto byte = static_cast<std::uint8_t>(stored);
		CHECK(std::abs(curve.linear(byte) - exact) < 1e-6);
		CHECK(std::abs(curve.linear(static_cast<float>(unit)) - exact) < 1e-6);
		CHECK(curve.encoded(curve.linear(byte)) == stored);
	}
	CHECK(curve.encoded(-1.0F) == 0);
	CHECK(curve.encoded(7.0F) == 255);
	CHECK(curve.encoded(static_cast<float>(nan_value)) == 0);
	CHECK(unit_byte(static_cast<float>(nan_value)) == 0);
	CHECK(unit_byte(0.5F) == 128);
}

TEST_CASE("impostor texture: textures repeat, and are interpolated between pixel centers") {
	SurfaceTexture texture;
	REQUIRE(texture.set(2, 1, std::vector<std::uint8_t>{255, 0, 0, 255, 0, 0, 0, 0}).ok());
	for (const float turn : {0.0F, 1.0F, -1.0F, 40.0F, -40.0F}) {
		CAPTURE(turn);
		CHECK(texture.sample({0.25F + turn, 0.5F}, 0).r == doctest::Approx(1.0));
		CHECK(texture.sample({0.75F + turn, 0.5F + turn}, 0).r == doctest::Approx(0.0));
		CHECK(texture.sample({0.5F + turn, 0.0F}, 0).a == doctest::Approx(0.5));
		CHECK(texture.sample({turn, 0.0F}, 0).r == doctest::Approx(0.5).epsilon(0.01));
	}
	CHECK(texture.sample({static_cast<float>(nan_value), static_cast<float>(infinite_value)}, 0).a >= 0.0F);
	CHECK(texture.sample({0.3F, 0.3F}, 1).a == doctest::Approx(128 / 255.0));
	// The mean of the sRGB bytes, as a linear value.
	CHECK(texture.sample({0.3F, 0.3F}, 1).r == doctest::Approx(0.2159).epsilon(0.001));
	CHECK(texture.level_for(3.9) == 0);
	CHECK(texture.level_for(4.0) == 1);
	CHECK(texture.level_for(1e9) == 1);
}

TEST_CASE("impostor texture: rejected input leaves the texture unchanged") {
	SurfaceTexture texture;
	const std::vector<std::uint8_t> pixels(16, 7);
	check_refused(texture.set(0, 4, pixels), ErrorCode::out_of_range, "texture", 0);
	check_refused(texture.set(4, 16385, pixels), ErrorCode::out_of_range, "texture", 16385);
	check_refused(texture.set(3, 2, pixels), ErrorCode::wrong_size, "texture", 16);
	CHECK(texture.sample({0.5F, 0.5F}, 0) == glm::vec4(1.0F));
}
