// Vector forms of dart.hpp; the same bits. Compiled once for each instruction set, by resolver.cpp.
#if defined(THICKET_DARTS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef THICKET_DARTS_INL
#undef THICKET_DARTS_INL
#else
#define THICKET_DARTS_INL
#endif

#include "core/sampling/level_grid.hpp"

#include <hwy/highway.h>

#include <algorithm>

HWY_BEFORE_NAMESPACE();
namespace thicket::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// High and low halves of the products of 32-bit lanes.
template <class V>
struct Product {
	V high;
	V low;
};

template <class D, class V = hn::Vec<D>>
HWY_INLINE Product<V> multiply(D d, V a, std::uint32_t b) {
	const hn::RepartitionToWide<D> wide;
	const V factor = hn::Set(d, b);
	const auto even = hn::MulEven(a, factor);
	const auto odd = hn::MulEven(hn::BitCast(d, hn::ShiftRight<32>(hn::BitCast(wide, a))), factor);
	return {hn::OddEven(hn::BitCast(d, odd), hn::BitCast(d, hn::ShiftRight<32>(even))),
			hn::OddEven(hn::BitCast(d, hn::ShiftLeft<32>(odd)), hn::BitCast(d, even))};
}

/// The first two words of philox4x32.
template <class V>
struct RandomBits {
	V first;
	V second;
};

template <class D, class V = hn::Vec<D>>
HWY_INLINE RandomBits<V> random_bits(D d, V c0, V c1, V c2, V c3, std::array<std::uint32_t, 2> key) {
	for (int round = 0; round < philox_rounds; ++round) {
		const Product<V> p0 = multiply(d, c0, philox_mul_0);
		const Product<V> p1 = multiply(d, c2, philox_mul_1);
		c0 = hn::Xor(hn::Xor(p1.high, c1), hn::Set(d, key[0]));
		c1 = p1.low;
		c2 = hn::Xor(hn::Xor(p0.high, c3), hn::Set(d, key[1]));
		c3 = p0.low;
		key[0] += philox_weyl_0;
		key[1] += philox_weyl_1;
	}
	return {c0, c1};
}

/// `exponential` of dart.hpp, operation for operation; multiplies and adds are never fused.
template <class D, class V = hn::Vec<D>>
HWY_INLINE auto exponentials(D d, V random) {
	const hn::RebindToSigned<D> di;
	const hn::RebindToFloat<D> df;
	const auto odd = hn::ConvertTo(df, hn::BitCast(di, hn::Or(hn::ShiftRight<8>(random), hn::Set(d, 1u))));
	const auto shifted = hn::Add(hn::BitCast(d, odd), hn::Set(d, 0x00400000u));
	const auto exponent = hn::Sub(hn::Set(di, 127 + 24), hn::BitCast(di, hn::ShiftRight<23>(shifted)));
	const auto mantissa = hn::BitCast(df, hn::Add(hn::And(shifted, hn::Set(d, 0x007fffffu)), hn::Set(d, 0x3f400000u)));
	const auto one = hn::Set(df, 1.0f);
	const auto s = hn::Div(hn::Sub(mantissa, one), hn::Add(mantissa, one));
	const auto s2 = hn::Mul(s, s);
	const auto s4 = hn::Mul(s2, s2);
	const auto low = hn::Add(hn::Mul(s2, hn::Set(df, 1.0f / 3.0f)), one);
	const auto high = hn::Add(hn::Add(hn::Mul(s2, hn::Set(df, 1.0f / 7.0f)), hn::Set(df, 1.0f / 5.0f)),
			hn::Mul(s4, hn::Set(df, 1.0f / 9.0f)));
	const auto series = hn::Add(hn::Mul(high, s4), low);
	const auto ln_mantissa = hn::Mul(hn::Add(s, s), series);
	return hn::Sub(hn::Mul(hn::ConvertTo(df, exponent), hn::Set(df, 0.693147180559945f)), ln_mantissa);
}

/// child_dart of all four children.
HWY_INLINE void child_darts(DartKey parent, DartKey *HWY_RESTRICT r_darts) {
	const hn::CappedTag<std::uint64_t, 4> d64;
	const hn::RepartitionToNarrow<decltype(d64)> d;
	const hn::RebindToFloat<decltype(d)> df;
	const std::uint32_t level = dart_level(dart_place(parent)) + 1;
	const std::uint32_t width = cell_size >> level;
	const std::uint32_t inside = (width - 1) | (width - 1) << lattice_bits;
	const CellPosition origin = square_origin(dart_place(parent)) | level << (2 * lattice_bits);
	alignas(32) static constexpr std::uint64_t steps[4] = {
			split_mix_gamma, 2 * split_mix_gamma, 3 * split_mix_gamma, 4 * split_mix_gamma};
	alignas(32) static constexpr std::uint64_t corners[4] = {0, 1, cell_size, 1 + cell_size};
	for (std::size_t lane = 0; lane < 4; lane += hn::MaxLanes(d64)) {
		auto random = hn::Add(hn::Set(d64, parent), hn::Load(d64, steps + lane));
		random = hn::Xor(random, hn::ShiftRight<30>(random)) * hn::Set(d64, split_mix_mul_0);
		random = hn::Xor(random, hn::ShiftRight<27>(random)) * hn::Set(d64, split_mix_mul_1);
		random = hn::Xor(random, hn::ShiftRight<31>(random));
		// Times live in the upper halves of the 64-bit lanes, as in the key; what the lower halves hold is replaced.
		const auto wait =
				hn::Mul(exponentials(d, hn::BitCast(d, random)), hn::Set(df, static_cast<float>(1u << (2 * level))));
		const auto time = hn::BitCast(d, hn::Add(hn::BitCast(df, hn::Set(d, dart_time(parent))), wait));
		const auto key = hn::Or(hn::And(time, hn::Set(d, ~tag_bits)), hn::Set(d, dart_time(parent) & tag_bits));
		const auto corner = hn::Or(hn::Set(d64, origin),
				hn::ShiftLeftSame(hn::Load(d64, corners + lane), lattice_bits - static_cast<int>(level)));
		const auto position = hn::Or(corner, hn::And(random, hn::Set(d64, inside)));
		hn::StoreU(hn::BitCast(d64, hn::OddEven(key, hn::BitCast(d, position))), d64, r_darts + lane);
	}
}

/// Gives every cell its first dart, and the border its unknown time.
HWY_INLINE void throw_base_darts(LevelGrid &grid) {
	const hn::ScalableTag<std::uint32_t> d;
	constexpr auto lanes = static_cast<std::int32_t>(hn::MaxLanes(d));
	const glm::ivec2 size = grid.cells.size() + 2 * LevelGrid::border;
	const std::size_t count = std::size_t{grid.stride} * static_cast<std::size_t>(size.y);
	std::fill_n(grid.time.begin(), count, time_unknown);
	std::fill_n(grid.point.begin(), count, LevelGrid::no_point);
	std::fill_n(grid.waiting.begin(), count, 0u);
	std::fill_n(grid.open.begin(), count, std::uint64_t{0});
	for (std::int32_t y = grid.cells.min.y; y < grid.cells.max.y; ++y) {
		std::uint32_t index = grid.index_of({grid.cells.min.x, y});
		const std::uint32_t row_tag = 5 * mod_5(y);
		std::fill_n(grid.open.data() + index, grid.cells.size().x, LevelGrid::all_open);
		for (std::int32_t x = grid.cells.min.x; x < grid.cells.max.x;
				x += lanes, index += static_cast<std::uint32_t>(lanes)) {
			const auto random = random_bits(d, hn::Iota(d, static_cast<std::uint32_t>(x)),
					hn::Set(d, static_cast<std::uint32_t>(y)), hn::Set(d, grid.source.stream), hn::Zero(d),
					grid.source.key);
			const auto time = hn::BitCast(d, exponentials(d, random.first));
			alignas(64) std::uint32_t tags[lanes];
			for (std::int32_t lane = 0; lane < lanes; ++lane) {
				tags[lane] = row_tag + mod_5(x + lane);
			}
			const auto key = hn::Or(hn::And(time, hn::Set(d, ~tag_bits)), hn::Load(d, tags));
			const auto position = hn::And(random.second, hn::Set(d, position_mask));
			const std::int32_t rest = std::min(lanes, grid.cells.max.x - x);
			if (rest == lanes) {
				hn::StoreU(key, d, grid.time.data() + index);
				hn::StoreU(position, d, grid.dart.data() + index);
			} else {
				alignas(64) std::uint32_t keys[lanes];
				alignas(64) std::uint32_t positions[lanes];
				hn::Store(key, d, keys);
				hn::Store(position, d, positions);
				std::copy_n(keys, rest, grid.time.data() + index);
				std::copy_n(positions, rest, grid.dart.data() + index);
			}
		}
	}
	grid.squares += static_cast<std::uint64_t>(grid.cells.size().x) * static_cast<std::uint64_t>(grid.cells.size().y);
}

} // namespace thicket::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
