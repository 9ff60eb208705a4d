#include "core/impostor/impostor_atlas.hpp"

#include "core/impostor/srgb.hpp"

#include <algorithm>

namespace thicket {

namespace {

/// The minimum alpha of a covered pixel.
constexpr std::size_t min_covered_alpha = 128;

using Histogram = std::array<std::size_t, 256>;

Histogram alphas_of(std::span<const std::uint8_t> rgba) {
	Histogram counts{};
	for (std::size_t byte = 3; byte < rgba.size(); byte += 4) {
		++counts[rgba[byte]];
	}
	return counts;
}

/// Returns the alpha threshold that a given fraction of all pixels reaches, as closely as possible.
std::size_t threshold_for(const Histogram &counts, std::size_t pixels, double fraction) {
	const double target_count = fraction * static_cast<double>(pixels);
	double count = 0.0;
	for (std::size_t alpha = 255; alpha > 0; --alpha) {
		const double next_count = count + static_cast<double>(counts[alpha]);
		if (next_count >= target_count) {
			return next_count - target_count <= target_count - count || alpha == 255 ? alpha : alpha + 1;
		}
		count = next_count;
	}
	return 1;
}

} // namespace

ImpostorAtlas::ImpostorAtlas(const ImpostorSettings &settings) {
	std::size_t size = 0;
	for (int side = settings.frames * settings.frame_size; side > 0; side /= 2) {
		levels_.push_back({side, size});
		size += 4 * static_cast<std::size_t>(side) * static_cast<std::size_t>(side);
	}
	for (int side = settings.frame_size; side > 0; side /= 2) {
		++whole_levels_;
	}
	albedo_.resize(size);
	normal_.resize(size);
}

void ImpostorAtlas::put(int column, int row, const FrameLevels &frame) {
	const SrgbCurve &curve = SrgbCurve::get();
	for (int level = 0; level < whole_levels_; ++level) {
		const int side = frame.side(level);
		const Level &atlas_level = levels_[static_cast<std::size_t>(level)];
		const FramePixel *pixel = frame.level(level).data();
		for (int y = 0; y < side; ++y) {
			std::size_t byte = atlas_level.first +
					4 *
							(static_cast<std::size_t>(row * side + y) * static_cast<std::size_t>(atlas_level.side) +
									static_cast<std::size_t>(column * side));
			for (int x = 0; x < side; ++x, ++pixel, byte += 4) {
				for (int axis = 0; axis < 3; ++axis) {
					const std::size_t channel = byte + static_cast<std::size_t>(axis);
					albedo_[channel] = curve.encoded(pixel->color[axis]);
					normal_[channel] = unit_byte(pixel->normal[axis] * 0.5F + 0.5F);
				}
				albedo_[byte + 3] = unit_byte(pixel->coverage);
				normal_[byte + 3] = unit_byte(pixel->depth * 0.5F + 0.5F);
			}
		}
	}
}

void ImpostorAtlas::finish() {
	for (std::size_t level = static_cast<std::size_t>(whole_levels_); level < levels_.size(); ++level) {
		shrink(albedo_, levels_[level - 1], levels_[level]);
		shrink(normal_, levels_[level - 1], levels_[level]);
	}
	const auto pixels_of = [](const Level &level) {
		return static_cast<std::size_t>(level.side) * static_cast<std::size_t>(level.side);
	};
	const Histogram finest = alphas_of(albedo_of(levels_[0]));
	std::size_t covered_count = 0;
	for (std::size_t alpha = min_covered_alpha; alpha < finest.size(); ++alpha) {
		covered_count += finest[alpha];
	}
	const double fraction = static_cast<double>(covered_count) / static_cast<double>(pixels_of(levels_[0]));
	for (std::size_t level = 1; level < levels_.size(); ++level) {
		const std::span<std::uint8_t> rgba = albedo_of(levels_[level]);
		const std::size_t threshold = threshold_for(alphas_of(rgba), pixels_of(levels_[level]), fraction);
		for (std::size_t alpha = 3; alpha < rgba.size(); alpha += 4) {
			rgba[alpha] =
					static_cast<std::uint8_t>(std::min<std::size_t>(rgba[alpha] * min_covered_alpha / threshold, 255));
		}
	}
}

std::span<std::uint8_t> ImpostorAtlas::albedo_of(const Level &level) {
	return std::span(albedo_).subspan(
			level.first, 4 * static_cast<std::size_t>(level.side) * static_cast<std::size_t>(level.side));
}

void ImpostorAtlas::shrink(std::vector<std::uint8_t> &r_bytes, const Level &finer, const Level &coarser) {
	const auto byte_at = [&](const Level &level, int x, int y) {
		return level.first +
				4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(level.side) + static_cast<std::size_t>(x));
	};
	for (int y = 0; y < coarser.side; ++y) {
		for (int x = 0; x < coarser.side; ++x) {
			for (std::size_t channel = 0; channel < 4; ++channel) {
				const int sum = r_bytes[byte_at(finer, 2 * x, 2 * y) + channel] +
						r_bytes[byte_at(finer, 2 * x + 1, 2 * y) + channel] +
						r_bytes[byte_at(finer, 2 * x, 2 * y + 1) + channel] +
						r_bytes[byte_at(finer, 2 * x + 1, 2 * y + 1) + channel];
				r_bytes[byte_at(coarser, x, y) + channel] = static_cast<std::uint8_t>((sum + 2) / 4);
			}
		}
	}
}

} // namespace thicket
