#pragma once

/// The point sampler for C++17 and later, with objects and exceptions. This header consists of calls to
/// the C library only (thicket.h, which documents all types).

#include "thicket.h"

#include <array>
#include <cstdint>
#include <memory>
#include <new>
#include <stdexcept>
#include <vector>

namespace thicket {

/// A call failed. `what()` names the argument and its value.
class Error : public std::runtime_error {
public:
	Error(thicket_code code, const char *message) : std::runtime_error(message), code_(code) {}
	thicket_code code() const noexcept { return code_; }

private:
	thicket_code code_;
};

/// The digests of the points of a sampler, see thicket_digest.
struct Digest {
	std::uint64_t places = 0;
	std::uint64_t ranks = 0;

	friend bool operator==(const Digest &a, const Digest &b) { return a.places == b.places && a.ranks == b.ranks; }
	friend bool operator!=(const Digest &a, const Digest &b) { return !(a == b); }
};

/// Generates points. One thread at a time may use a sampler, except for `cancel`. Reuse a sampler for many
/// calls, because it keeps its memory.
class Sampler {
public:
	/// Throws Error if the library has another major version than this header, and std::bad_alloc.
	Sampler() : sampler_(created()) {}

	/// Returns the points of a set in a rectangle, at most 1e8. Throws Error and std::bad_alloc.
	std::vector<thicket_point> sample(
			const thicket_set &set, const thicket_rect &rect, const thicket_watch *watch = nullptr) {
		std::uint64_t count = 0;
		check(thicket_sample(sampler_.get(), &set, &rect, watch, &count));
		std::vector<thicket_point> points(count);
		check(thicket_read_points(sampler_.get(), 0, count, points.data()));
		return points;
	}

	/// Returns the positions (x, y) of the points that fill a whole domain, at most 1e9. Throws Error and
	/// std::bad_alloc.
	std::vector<std::array<double, 2>> sample_domain(
			const thicket_domain &domain, const thicket_watch *watch = nullptr) {
		std::uint64_t count = 0;
		check(thicket_sample_domain(sampler_.get(), &domain, watch, &count));
		std::vector<std::array<double, 2>> positions(count);
		check(thicket_read_positions(sampler_.get(), 0, count, positions.empty() ? nullptr : positions[0].data()));
		return positions;
	}

	/// Returns the digests of the points of the last call. Throws Error if there are none.
	Digest digest() {
		Digest digest;
		check(thicket_digest(sampler_.get(), &digest.places, &digest.ranks));
		return digest;
	}

	/// Ends the call in progress, which throws an Error with THICKET_CANCELLED. Any thread may call this.
	void cancel() noexcept { thicket_cancel(sampler_.get()); }

private:
	struct Free {
		void operator()(thicket_sampler *sampler) const noexcept { thicket_sampler_free(sampler); }
	};

	static thicket_sampler *created() {
		if (thicket_c_version() / 1000 != THICKET_C_VERSION / 1000) {
			throw Error(THICKET_FAILED, "the library thicket_c has another major version than its header");
		}
		thicket_sampler *sampler = thicket_sampler_new();
		if (sampler == nullptr) {
			throw std::bad_alloc();
		}
		return sampler;
	}

	void check(thicket_code code) const {
		if (code == THICKET_OUT_OF_MEMORY) {
			throw std::bad_alloc();
		}
		if (code != THICKET_OK) {
			throw Error(code, thicket_message(sampler_.get()));
		}
	}

	std::unique_ptr<thicket_sampler, Free> sampler_;
};

} // namespace thicket
