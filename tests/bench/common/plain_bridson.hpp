#pragma once

#include "random.hpp"

#include <glm/vec2.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace thicket::bench {

/// Bridson, "Fast Poisson disk sampling in arbitrary dimensions" (2007), in two dimensions, as in
/// the paper and in most programs. It uses single precision, a background grid of indices with
/// cells of side r / sqrt(2), and candidates by angle and radius. This is the plain baseline;
/// `Bridson` is the same method after tuning. The sets are not maximal, and not distributed like
/// those of dart throwing. An object of this class keeps its memory between calls.
class PlainBridson {
public:
	/// The number of candidates around an active point before it becomes inactive, as in the paper.
	static constexpr int attempts = 30;

	/// Replaces `r_points` with a set in [0, size.x) x [0, size.y) in which no two points are
	/// closer than 1. Both sizes must be > 0.
	void sample(glm::vec2 size, std::uint64_t seed, std::vector<glm::vec2> &r_points) {
		size_ = size;
		columns_ = static_cast<int>(size.x * per_cell) + 1;
		rows_ = static_cast<int>(size.y * per_cell) + 1;
		grid_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), -1);
		r_points.clear();
		active_.clear();

		Xoroshiro random(seed);
		const glm::vec2 first = glm::vec2(unit(random), unit(random)) * size;
		insert({std::min(first.x, std::nextafter(size.x, 0.0f)), std::min(first.y, std::nextafter(size.y, 0.0f))},
				r_points);
		while (!active_.empty()) {
			const std::uint32_t slot = random.below(static_cast<std::uint32_t>(active_.size()));
			const glm::vec2 parent = r_points[static_cast<std::size_t>(active_[slot])];
			if (!grow(parent, random, r_points)) {
				active_[slot] = active_.back();
				active_.pop_back();
			}
		}
	}

private:
	static constexpr float per_cell = 1.41421356f;

	glm::vec2 size_{0.0f};
	int columns_ = 0;
	int rows_ = 0;
	std::vector<std::int32_t> grid_;
	std::vector<std::int32_t> active_;

	static float unit(Xoroshiro &random) { return static_cast<float>(random() >> 40) * 0x1p-24f; }

	std::int32_t &cell(int x, int y) {
		return grid_[static_cast<std::size_t>(y) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(x)];
	}

	void insert(glm::vec2 point, std::vector<glm::vec2> &r_points) {
		const auto index = static_cast<std::int32_t>(r_points.size());
		cell(static_cast<int>(point.x * per_cell), static_cast<int>(point.y * per_cell)) = index;
		active_.push_back(index);
		r_points.push_back(point);
	}

	/// Tries up to `attempts` candidates around `parent`. Returns true if one was added.
	bool grow(glm::vec2 parent, Xoroshiro &random, std::vector<glm::vec2> &r_points) {
		for (int attempt = 0; attempt < attempts; ++attempt) {
			const float radius = std::sqrt(1.0f + 3.0f * unit(random));
			const float angle = 6.28318531f * unit(random);
			const glm::vec2 candidate = parent + radius * glm::vec2(std::cos(angle), std::sin(angle));
			const bool is_inside =
					candidate.x >= 0.0f && candidate.y >= 0.0f && candidate.x < size_.x && candidate.y < size_.y;
			if (is_inside && free(candidate, r_points)) {
				insert(candidate, r_points);
				return true;
			}
		}
		return false;
	}

	bool free(glm::vec2 candidate, const std::vector<glm::vec2> &points) {
		const int column = static_cast<int>(candidate.x * per_cell);
		const int row = static_cast<int>(candidate.y * per_cell);
		const int last_column = std::min(column + 2, columns_ - 1);
		const int last_row = std::min(row + 2, rows_ - 1);
		for (int y = std::max(row - 2, 0); y <= last_row; ++y) {
			for (int x = std::max(column - 2, 0); x <= last_column; ++x) {
				const std::int32_t index = cell(x, y);
				if (index < 0) {
					continue;
				}
				const glm::vec2 offset = points[static_cast<std::size_t>(index)] - candidate;
				if (offset.x * offset.x + offset.y * offset.y < 1.0f) {
					return false;
				}
			}
		}
		return true;
	}
};

} // namespace thicket::bench
