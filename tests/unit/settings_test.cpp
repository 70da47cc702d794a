#include "plumb/settings.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>

#include "plumb/error.hpp"
#include "support/refusals.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

/// The message of the InputError that validate() throws, or empty if it throws none.
std::string refusal(const std::function<void(Settings&)>& change) {
  Settings settings;
  change(settings);
  return test::refusal([&] { validate(settings); });
}

TEST(Settings, DefaultsAreValid) {
  EXPECT_NO_THROW(validate(Settings{}));
}

TEST(Settings, OmegaIsBetweenZeroAndTwo) {
  EXPECT_EQ(refusal([](Settings& s) { s.omega = 2.5; }), "omega must be in (0, 2), got 2.5");
  EXPECT_EQ(refusal([](Settings& s) { s.omega = 2; }), "omega must be in (0, 2), got 2");
  EXPECT_EQ(refusal([](Settings& s) { s.omega = 0; }), "omega must be in (0, 2), got 0");
  EXPECT_EQ(refusal([](Settings& s) { s.omega = nan; }), "omega must be in (0, 2), got nan");
  EXPECT_EQ(refusal([](Settings& s) { s.omega = 1.997; }), "");
}

TEST(Settings, ContactAndSleepAreChecked) {
  EXPECT_EQ(refusal([](Settings& s) { s.contact.length_scale = 0; }),
            "length scale must be positive and finite, got 0");
  EXPECT_EQ(refusal([](Settings& s) { s.contact.margin = nan; }),
            "contact margin must be positive and finite, got nan m");
  EXPECT_EQ(refusal([](Settings& s) { s.contact.slop = -1e-3; }),
            "contact slop must be 0 or more and finite, got -0.001 m");
  EXPECT_EQ(refusal([](Settings& s) { s.contact.recovery = 1.5; }),
            "contact recovery must be from 0 to 1, got 1.5");
  EXPECT_EQ(refusal([](Settings& s) { s.sleep_time = infinity; }),
            "sleep time must be 0 or more and finite, got inf s");
  EXPECT_EQ(refusal([](Settings& s) { s.most_work = 0; }), "most work must be at least 1, got 0");
  EXPECT_EQ(refusal([](Settings& s) { s.contact = {.length_scale = 0.01, .slop = 0, .recovery = 1}; }), "");
}

TEST(Settings, SubstepsAreOneToAMillion) {
  EXPECT_EQ(refusal([](Settings& s) { s.substeps = 0; }), "substeps must be from 1 to 1000000, got 0");
  EXPECT_EQ(refusal([](Settings& s) { s.substeps = 1'000'001; }),
            "substeps must be from 1 to 1000000, got 1000001");
  EXPECT_EQ(refusal([](Settings& s) { s.substeps = 1'000'000; }), "");
}

TEST(Settings, StopRulesArePositive) {
  EXPECT_EQ(refusal([](Settings& s) { s.stop.sweeps = 0; }), "sweeps must be at least 1, got 0");
  EXPECT_EQ(refusal([](Settings& s) { s.stop.tolerance = 0; }),
            "tolerance must be positive and finite, got 0");
  EXPECT_EQ(refusal([](Settings& s) { s.stop.tolerance = -1e-3; }),
            "tolerance must be positive and finite, got -0.001");
  EXPECT_EQ(refusal([](Settings& s) { s.stop.tolerance = infinity; }),
            "tolerance must be positive and finite, got inf");
  EXPECT_EQ(refusal([](Settings& s) { s.stop.tolerance = nan; }),
            "tolerance must be positive and finite, got nan");
  EXPECT_EQ(refusal([](Settings& s) { s.stop.budget_us = 0; }),
            "budget must be positive and finite, got 0 us");
  EXPECT_EQ(refusal([](Settings& s) { s.stop.budget_us = nan; }),
            "budget must be positive and finite, got nan us");
  EXPECT_EQ(refusal([](Settings& s) { s.stop = {.sweeps = 1, .tolerance = 1e-9, .budget_us = 50.0}; }), "");
}

TEST(StopRules, AreValidatedAlone) {
  EXPECT_NO_THROW(validate(StopRule{}));
  EXPECT_NO_THROW(validate(StopRule{.sweeps = 1, .tolerance = 1e-9, .budget_us = 50.0}));
  EXPECT_THROW(validate(StopRule{.sweeps = 0}), InputError);
  EXPECT_THROW(validate(StopRule{.tolerance = nan}), InputError);
  EXPECT_THROW(validate(StopRule{.budget_us = -1.0}), InputError);
}

TEST(Settings, EveryMethodIsAccepted) {
  for (const Method method : {Method::relax, Method::automatic, Method::direct, Method::springs,
                              Method::multipliers, Method::featherstone}) {
    Settings settings;
    settings.method = method;
    EXPECT_NO_THROW(validate(settings));
  }
}

TEST(Settings, TimeOrdersGoWithGradientOld) {
  const auto with = [](std::uint32_t order, Method method, std::optional<Gradient> gradient) {
    return refusal([=](Settings& s) {
      s.time_order = order;
      s.method = method;
      s.gradient = gradient;
    });
  };
  for (const std::uint32_t order : {2u, 4u, 6u}) EXPECT_EQ(with(order, Method::direct, Gradient::old), "");
  EXPECT_EQ(with(3, Method::direct, Gradient::old), "time order must be 2, 4 or 6, got 3");
  EXPECT_EQ(with(4, Method::direct, Gradient::mid), "time order 4 needs method direct with gradient old");
  EXPECT_EQ(with(4, Method::direct, std::nullopt), "time order 4 needs method direct with gradient old");
  EXPECT_EQ(with(6, Method::relax, Gradient::old),
            "method relax does not read time order; it is read by direct");
}

TEST(Settings, IntegratorsGoWithTheirMethods) {
  EXPECT_EQ(integrator_of({.method = Method::springs}), Integrator::implicit_euler);
  EXPECT_EQ(integrator_of({.method = Method::multipliers}), Integrator::rk4);
  EXPECT_EQ(refusal([](Settings& s) {
              s.method = Method::multipliers;
              s.integrator = Integrator::implicit_euler;
            }),
            "integrator implicit-euler needs method springs");
  EXPECT_EQ(refusal([](Settings& s) {
              s.method = Method::springs;
              s.integrator = Integrator::adaptive_implicit_euler;
            }),
            "integrator adaptive-implicit-euler needs an accuracy");
  EXPECT_EQ(refusal([](Settings& s) {
              s.method = Method::springs;
              s.integrator = Integrator::adaptive_implicit_euler;
              s.accuracy = 1e-3;
            }),
            "");
  EXPECT_EQ(refusal([](Settings& s) { s.springs.stiffness = 0; }),
            "stiffness must be positive and finite, got 0 N/m");
  EXPECT_EQ(refusal([](Settings& s) { s.springs.damping_ratio = nan; }),
            "damping ratio must be 0 or more and finite, got nan");
  EXPECT_EQ(refusal([](Settings& s) { s.multipliers.baumgarte_rate = -1; }),
            "baumgarte rate must be positive and finite, got -1 1/s");
}

TEST(Isas, AreListedFromTheScalarOneUp) {
  ASSERT_FALSE(all_isas().empty());
  EXPECT_EQ(all_isas().front(), Isa::scalar);
  EXPECT_TRUE(is_supported(Isa::scalar));
  EXPECT_TRUE(is_supported(best_isa()));
  for (const Isa isa : all_isas())
    if (is_supported(isa)) {
      EXPECT_LE(isa, best_isa()) << to_string(isa);
    }
  EXPECT_FALSE(is_supported(static_cast<Isa>(99)));
}

TEST(ToString, SpeaksTheCommandLine) {
  EXPECT_EQ(to_string(Method::automatic), "auto");
  EXPECT_EQ(to_string(Method::relax), "relax");
  EXPECT_EQ(to_string(Method::direct), "direct");
  EXPECT_EQ(to_string(Method::springs), "springs");
  EXPECT_EQ(to_string(Method::multipliers), "multipliers");
  EXPECT_EQ(to_string(Method::featherstone), "featherstone");
  EXPECT_EQ(to_string(Precision::single), "float");
  EXPECT_EQ(to_string(Precision::double_), "double");
  EXPECT_EQ(to_string(Gradient::new_), "new");
  EXPECT_EQ(to_string(Gradient::old), "old");
  EXPECT_EQ(to_string(Gradient::mid), "mid");
  EXPECT_EQ(to_string(Weights::mass), "mass");
  EXPECT_EQ(to_string(Weights::equal), "equal");
  EXPECT_EQ(to_string(SweepOrder::gauss_seidel), "gauss-seidel");
  EXPECT_EQ(to_string(SweepOrder::jacobi), "jacobi");
  EXPECT_EQ(to_string(LayoutChoice::automatic), "auto");
  EXPECT_EQ(to_string(LayoutChoice::aos), "aos");
  EXPECT_EQ(to_string(LayoutChoice::soa), "soa");
  EXPECT_EQ(to_string(LayoutChoice::aosoa), "aosoa");
  EXPECT_EQ(to_string(Isa::scalar), "scalar");
  EXPECT_EQ(to_string(Isa::sse2), "sse2");
  EXPECT_EQ(to_string(Isa::avx2), "avx2");
  EXPECT_EQ(to_string(Isa::avx512), "avx512");
  EXPECT_EQ(to_string(Isa::neon), "neon");
  EXPECT_EQ(to_string(Isa::simd128), "simd128");
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
