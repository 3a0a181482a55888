#include "io/model_file.h"

#include <gtest/gtest.h>

#include <string>

#include "models/errors.h"

namespace handloop::io {
namespace {

constexpr const char* kArm = R"(base = "arm5"
[arm]
axis = "y"
mass_kg = 0.2179
k1_N_per_m = 379.5
k2_N_per_m = 78.75
b1_Ns_per_m = 1.839
b2_Ns_per_m = 4.645
)";

std::string refusal(const std::string& text) {
  try {
    parse_model(text, "arm.toml");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

void expect_message(const std::string& text, std::initializer_list<const char*> words) {
  const auto message = refusal(text);
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  for (const auto* word : words) EXPECT_NE(message.find(word), std::string::npos) << "'" << word << "' in: " << message;
}

std::string replaced(std::string text, const std::string& what, const std::string& with) {
  return text.replace(text.find(what), what.size(), with);
}

TEST(ModelFile, OfTheContractIsRead) {
  const auto model = parse_model(kArm, "arm.toml");
  EXPECT_EQ(model.base, models::BaseModel::arm5);
  EXPECT_EQ(model.axis, models::Axis::y);
  EXPECT_EQ(model.arm, (models::ArmParameters{0.2179, 379.5, 78.75, 1.839, 4.645}));
  EXPECT_FALSE(model.rotary);
  EXPECT_TRUE(model.effects.empty());
}

TEST(ModelFile, MayLeaveOutItsBase) {
  EXPECT_EQ(parse_model(replaced(kArm, "base = \"arm5\"\n", ""), "arm.toml").base, models::BaseModel::arm5);
  EXPECT_EQ(parse_model("[msd]\nmass_kg=1\nb_Ns_per_m=2\nk_N_per_m=0\n", "m.toml").base, models::BaseModel::msd);
}

TEST(ModelFile, ReadsRotaryPlants) {
  const auto model =
      parse_model("base=\"msd\"\n[msd]\ninertia_kg_m2=0.01\nb_Nms_per_rad=0.2\nk_Nm_per_rad=3\n", "m.toml");
  EXPECT_TRUE(model.rotary);
  EXPECT_EQ(model.msd, (models::MsdParameters{0.01, 0.2, 3}));
}

TEST(ModelFile, ComesBackToTheSameBits) {
  auto model = parse_model(kArm, "arm.toml");
  model.arm.mass_kg = 1.0 / 3.0;
  model.arm.b1_Ns_per_m = 2e-4 / 7.0;
  auto back = parse_model(to_toml(model), "again.toml");
  EXPECT_EQ(back.arm, model.arm);
  EXPECT_EQ(back.axis, model.axis);
  model.rotary = true;
  back = parse_model(to_toml(model), "again.toml");
  EXPECT_EQ(back.arm, model.arm);
  EXPECT_TRUE(back.rotary);
  model.base = models::BaseModel::msd;
  model.msd = {0.1, 0.7, 0};
  back = parse_model(to_toml(model), "again.toml");
  EXPECT_EQ(back.msd, model.msd);
}

TEST(ModelFile, KeepsEveryEffectOfTheCatalogue) {
  for (const auto& type : models::effect_catalogue()) {
    for (const auto place : type.info.places) {
      auto model = parse_model(kArm, "arm.toml");
      model.effects.push_back(models::make_typical_effect(type.info.name, place));
      model.effects.push_back(models::make_typical_effect(type.info.name, type.info.places.front()));
      const auto back = parse_model(to_toml(model), "again.toml");
      ASSERT_EQ(back.effects.size(), 2U) << type.info.name;
      const auto& effect = *back.effects.front();
      EXPECT_EQ(effect.info().name, type.info.name);
      EXPECT_EQ(effect.place(), place);
      for (std::size_t i = 0; i < type.info.parameters.size(); ++i) {
        EXPECT_EQ(effect.parameters()[i], model.effects.front()->parameters()[i]) << type.info.name;
      }
    }
  }
}

TEST(ModelFile, IsRefusedWithLineAndKey) {
  expect_message("[arm\naxis=1", {"arm.toml", "line 1", "TOML"});
  expect_message(replaced(kArm, "b2_Ns_per_m", "b2_Ns_per_n"),
                 {"line 8", "'b2_Ns_per_n'", "did you mean 'b2_Ns_per_m'"});
  expect_message(replaced(kArm, "b2_Ns_per_m = 4.645\n", ""), {"arm.toml", "lacks b2_Ns_per_m"});
  expect_message(replaced(kArm, "= 0.2179", "= -1"), {"line 4", "mass_kg", "-1", "above 0"});
  expect_message(replaced(kArm, "= 0.2179", "= 0"), {"line 4", "mass_kg", "above 0"});
  expect_message(replaced(kArm, "= 0.2179", "= nan"), {"line 4", "mass_kg", "finite"});
  expect_message(replaced(kArm, "= 0.2179", "= \"light\""), {"line 4", "mass_kg", "number", "text"});
  expect_message(replaced(kArm, "\"y\"", "\"q\""), {"line 3", "axis", "'q'", "left-right"});
  expect_message(replaced(kArm, "\"arm5\"", "\"arm6\""), {"line 1", "base", "arm6", "arm5"});
  expect_message(replaced(kArm, "[arm]", "[amr]"), {"line 2", "'amr'", "did you mean 'arm'"});
  expect_message(replaced(kArm, "\"arm5\"", "\"msd\""), {"arm", "msd"});
  expect_message("", {"arm.toml", "lacks the table [arm]"});
  expect_message("arm = 3", {"line 1", "table"});
  expect_message("base=\"msd\"\n[msd]\ninertia_kg_m2=0.01\nb_Ns_per_m=0.2\nk_Nm_per_rad=3\n",
                 {"line 4", "b_Ns_per_m", "rotary"});
  expect_message(std::string(kArm) + "[effect]\nname = \"tremor\"\n", {"line 9", "effect", "[[effect]]"});
}

TEST(ModelFile, NamesTheNearestEffectPlaceAndParameter) {
  if (models::effect_catalogue().empty()) GTEST_SKIP() << "the catalogue is empty";
  expect_message(std::string(kArm) + "[[effect]]\nname=\"coulom_friction\"\n",
                 {"line 10", "'coulom_friction'", "did you mean 'coulomb_friction'"});
  expect_message(std::string(kArm) + "[[effect]]\nnam=\"coulomb_friction\"\n",
                 {"line 10", "'nam'", "did you mean 'name'"});
  expect_message(std::string(kArm) + "[[effect]]\nname=\"coulomb_friction\"\nacts_on=\"elbow\"\n",
                 {"line 11", "acts_on", "'elbow'", "arm"});
  expect_message(std::string(kArm) + "[[effect]]\nname=\"coulomb_friction\"\n[effect.parameters]\nfore_N=1\n",
                 {"line 12", "'fore_N'", "did you mean 'force_N'"});
  expect_message(std::string(kArm) + "[[effect]]\nname=\"coulomb_friction\"\n[effect.parameters]\nforce_N=-1\n",
                 {"line 12", "force_N", "-1", "0"});
}

}  // namespace
}  // namespace handloop::io
