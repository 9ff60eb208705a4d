#include "core/impostor/surface_texture.hpp"

#include "core/base/check.hpp"
#include "core/base/guard.hpp"
#include "core/impostor/srgb.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace thicket {

namespace {

/// Wraps a texture coordinate and converts it to pixels, in [0, count). The result is 0 for
/// coordinates that are not finite, or so large that a float cannot distinguish pixels.
float wrapped(float coordinate, int count) {
	constexpr float farthest = 1e6F;
	if (!(coordinate > -farthest && coordinate < farthest)) {
		return 0.0F;
	}
	const auto integer_part = static_cast<int>(coordinate);
	const float fraction = coordinate - static_cast<float>(integer_part);
	const float unit = fraction < 0.0F ? fraction + 1.0F : fraction;
	return std::min(unit * static_cast<float>(count), static_cast<float>(count) - 1e-3F);
}

} // namespace

std::size_t SurfaceTexture::Level::byte_offset(int x, int y) const {
	return first + 4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x));
}

Status SurfaceTexture::set(int width, int height, std::span<const std::uint8_t> rgba) {
	const Status size_status = first_failure(check_range("texture", width, 1.0, max_texture_side),
			check_range("texture", height, 1.0, max_texture_side));
	const std::size_t count = 4 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
	if (!size_status.ok() || rgba.size() != count) {
		return size_status.ok() ? Status::wrong_size("texture", rgba.size(), exactly(count, "bytes")) : size_status;
	}
	return guarded("texture", static_cast<double>(count), [&] {
		SurfaceTexture texture;
		texture.levels_.assign(1, {width, height, 0});
		texture.pixels_.assign(rgba.begin(), rgba.end());
		while (width > 1 || height > 1) {
			const Level finer = texture.levels_.back();
			width = std::max(width / 2, 1);
			height = std::max(height / 2, 1);
			texture.levels_.push_back({width, height, texture.pixels_.size()});
			texture.pixels_.reserve(
					texture.pixels_.size() + 4 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
			for (int y = 0; y < height; ++y) {
				for (int x = 0; x < width; ++x) {
					const int right = std::min(2 * x + 1, finer.width - 1);
					const int bottom = std::min(2 * y + 1, finer.height - 1);
					const std::array<std::size_t, 4> pixels{finer.byte_offset(2 * x, 2 * y),
							finer.byte_offset(right, 2 * y), finer.byte_offset(2 * x, bottom),
							finer.byte_offset(right, bottom)};
					for (std::size_t channel = 0; channel < 4; ++channel) {
						int sum = 2; // Starting at 2 rounds the quotient to the nearest integer.
						for (const std::size_t pixel : pixels) {
							sum += texture.pixels_[pixel + channel];
						}
						texture.pixels_.push_back(static_cast<std::uint8_t>(sum / 4));
					}
				}
			}
		}
		*this = std::move(texture);
	});
}

int SurfaceTexture::level_for(double area) const {
	int level = 0;
	while (area >= 4.0 && level + 1 < static_cast<int>(levels_.size())) {
		area *= 0.25;
		++level;
	}
	return level;
}

glm::vec4 SurfaceTexture::pixel(const Level &level, int x, int y) const {
	const std::uint8_t *bytes = pixels_.data() + level.byte_offset(x, y);
	const SrgbCurve &curve = SrgbCurve::get();
	return {curve.linear(bytes[0]), curve.linear(bytes[1]), curve.linear(bytes[2]),
			static_cast<float>(bytes[3]) * (1.0F / 255.0F)};
}

glm::vec4 SurfaceTexture::sample(glm::vec2 uv, int level_index) const {
	const Level &level = levels_[static_cast<std::size_t>(level_index)];
	// The coordinates are positive, because the casts truncate.
	const float x = wrapped(uv.x, level.width) + static_cast<float>(level.width) - 0.5F;
	const float y = wrapped(uv.y, level.height) + static_cast<float>(level.height) - 0.5F;
	const auto column = static_cast<int>(x);
	const auto row = static_cast<int>(y);
	const float x_fraction = x - static_cast<float>(column);
	const float y_fraction = y - static_cast<float>(row);
	const int left_column = column % level.width;
	const int right_column = (column + 1) % level.width;
	const int top_row = row % level.height;
	const int bottom_row = (row + 1) % level.height;
	const glm::vec4 top =
			pixel(level, left_column, top_row) * (1.0F - x_fraction) + pixel(level, right_column, top_row) * x_fraction;
	const glm::vec4 bottom = pixel(level, left_column, bottom_row) * (1.0F - x_fraction) +
			pixel(level, right_column, bottom_row) * x_fraction;
	return top * (1.0F - y_fraction) + bottom * y_fraction;
}

} // namespace thicket
