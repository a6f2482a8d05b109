// Model files of MuJoCo 3: their files, what becomes of each word, and the forces of MuJoCo 3
// itself.
#include <mujoco/mujoco.h>
#include <cstdint>

#include <breakwater/plants/mjcf_tree.h>
#include <breakwater/sim/mjcf_conversion.h>
#include <breakwater/sim/model.h>
#include "shell.h"
#include "support.h"
#include "tables.h"

namespace breakwater::mjcf_conversion_test {

namespace fs = std::filesystem;

class MjcfConversion : public ::testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_); }

  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
    return (folder_ / name).string();
  }

  const testing::TemporaryPath folder_{"mjcf_conversion"};
};

// An arm of two links. The rows of a table add to its sections.
std::string arm(const std::string& body, const std::string& other,
                const std::string& first_joint = "") {
  return R"(<mujoco><compiler angle="radian"/><worldbody><body name="upper">
<inertial mass="2" pos="0.1 0 0.2" diaginertia="0.1 0.2 0.3"/><joint name="a" axis="0 1 0" )" +
         first_joint + R"(/>
<site name="mount" pos="0.1 0.2 0.3" euler="0.1 0.2 0.3"/>
<body name="lower" pos="0 0 0.5"><inertial mass="1" pos="0.1 0.1 0" diaginertia="0.02 0.03 0.04"/>
<joint name="b" axis="1 0 0"/><site name="tip" pos="0 0.1 0.4" zaxis="1 1 1"/></body></body>)" +
         body + "</worldbody>" + other + "</mujoco>";
}

struct Row {
  std::string file;
  std::string expected;  // a part of the converted text
  std::string change;    // LOSS and what; empty: none
};

TEST_F(MjcfConversion, GivesTheEnginesWords) {
  // M of joint a at the reference pose is 0.6 + 2·0.05 + 1·0.26 + …; the oracle checks it.
  std::vector<Row> rows = {{"<robot name=\"r\"><link name=\"l\"/></robot>", "<robot", ""}};
  for (const auto& row : testing::rows_of("MjcfWords")) {
    rows.push_back({arm(row.at(0), row.at(1), row.at(2)), row.at(3), row.at(4)});
  }
  for (const Row& row : rows) {
    SCOPED_TRACE(row.file);
    const ConvertedMjcf converted =
        convert_mjcf(write("model.xml", row.file), ModelFile::kMostElements);
    EXPECT_NE(mjcf_text(converted.root).find(row.expected), std::string::npos)
        << mjcf_text(converted.root);
    std::set<std::string> changes = {""};
    for (const MjcfChange& one : converted.changes) {
      changes.insert(std::to_string(static_cast<int>(one.loss)) + one.what);
    }
    EXPECT_EQ(converted.changes.empty(), row.change.empty());
    EXPECT_TRUE(changes.contains(row.change)) << *changes.rbegin();
    if (!row.file.starts_with("<mujoco")) continue;
    EXPECT_NO_THROW(Model::load((folder_ / "model.xml").string()));
  }
}

TEST_F(MjcfConversion, RefusesByName) {
  for (const auto& row : testing::rows_of("MjcfRefusals")) {
    const std::string text = arm(row.at(0), row.at(1));
    SCOPED_TRACE(text);
    try {
      Model::load(write("model.xml", text));
      ADD_FAILURE() << "was loaded";
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find(row.at(2)), std::string::npos) << error.what();
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    }
  }
}

TEST_F(MjcfConversion, TheModelsOfTheProjectNeedNone) {
  for (const auto& entry : fs::recursive_directory_iterator(testing::source_file("models"))) {
    if (entry.path().extension() != ".xml") continue;
    EXPECT_TRUE(convert_mjcf(entry.path().string(), ModelFile::kMostElements).changes.empty())
        << entry.path();
  }
}

// An attached model has its names with a prefix, its own defaults, and what refers to it alone.
TEST_F(MjcfConversion, AttachesAModel) {
  fs::create_directories(folder_ / "parts");
  write("parts/hand.xml", R"(<mujoco><default><geom size="0.1" mass="3"/></default><worldbody>
<body name="hand" pos="0 0 1"><joint name="j" axis="0 0 1"/><geom name="palm"/></body>
<body name="other"><joint name="k"/><geom/></body></worldbody>
<actuator><motor name="m" joint="j"/><motor joint="k"/></actuator></mujoco>)");
  const std::string file =
      write("model.xml", R"(<mujoco><asset><model name="h" file="parts/hand.xml"/>
</asset><worldbody><body name="arm" pos="1 0 0"><joint/><geom size="0.2"/>
<frame pos="0 2 0"><attach model="h" body="hand" prefix="left_"/></frame>
<frame pos="0 -2 0"><attach model="h" body="hand" prefix="right_"/></frame></body></worldbody>
</mujoco>)");
  const Model model = Model::load(file);
  ASSERT_EQ(model->nbody, 4);
  ASSERT_EQ(model->nu, 2);
  const int hand = model.id(mjOBJ_BODY, "right_hand");
  EXPECT_EQ(model->body_parentid[hand], model.id(mjOBJ_BODY, "arm"));
  EXPECT_EQ(model->body_pos[3 * hand + 1], -2.0);
  EXPECT_EQ(model->body_pos[3 * hand + 2], 1.0);
  EXPECT_EQ(model->body_mass[hand], 3.0);
  EXPECT_EQ(model->actuator_trnid[2 * model.id(mjOBJ_ACTUATOR, "left_m")],
            model.id(mjOBJ_JOINT, "left_j"));
  EXPECT_EQ(mjcf_files(file).size(), 2U);
}

// Random states: qpos near the reference pose, and velocities, activations and commands.
std::vector<std::vector<double>> random_states(const mjModel& m, int count, double speed) {
  testing::Random random;
  std::vector<std::vector<double>> states;
  for (int i = 0; i < count; ++i) {
    std::vector<double> state(m.qpos0, m.qpos0 + m.nq);
    const Eigen::VectorXd moved = random.vector(m.nv, 0.5);
    mj_integratePos(&m, state.data(), moved.data(), 1.0);
    for (int k = 0; k < m.nv; ++k) state.push_back(speed * random.uniform(-1.0, 1.0));
    for (int k = 0; k < m.na + m.nu; ++k) state.push_back(random.uniform(-1.0, 1.0));
    states.push_back(state);
  }
  return states;
}

// The largest difference of accelerations and actuators' forces over the largest of them.
double difference_to_mujoco3(const std::string& file, const fs::path& folder, double speed = 1.0) {
  const Model model = Model::load(file);
  mjModel& m = *const_cast<mjModel*>(model.get());
  m.opt.disableflags |= mjDSBL_CONTACT;  // the search for contacts is another one in MuJoCo 3
  m.opt.tolerance = 0.0;
  m.opt.iterations = 200;
  const auto states = random_states(m, 50, speed);
  {
    std::ofstream stream(folder / "states.txt");
    stream.precision(17);
    for (const auto& state : states) {
      for (std::size_t i = 0; i < state.size(); ++i) stream << (i > 0 ? " " : "") << state[i];
      stream << '\n';
    }
  }
  std::istringstream theirs(testing::output_of("node " +
                                               testing::source_file("tests/sim/mujoco3.mjs") + " " +
                                               file + " " + (folder / "states.txt").string()));
  const DataPointer data = model.make_data();
  double largest = 0.0, difference = 0.0;
  for (const auto& state : states) {
    const double* from = state.data();
    for (const auto& [to, size] :
         {std::pair(data->qpos, m.nq), {data->qvel, m.nv}, {data->act, m.na}, {data->ctrl, m.nu}}) {
      std::copy_n(from, size, to);
      from += size;
    }
    mj_forward(&m, data.get());
    // The forces as the joints get them: MuJoCo 3 limits those of a joint behind the actuator's.
    std::vector<double> ours(data->qacc, data->qacc + m.nv);
    ours.insert(ours.end(), data->qfrc_actuator, data->qfrc_actuator + m.nv);
    for (const double own : ours) {
      double other = 0.0;
      theirs >> other;
      largest = std::max(largest, std::abs(other));
      difference = std::max(difference, std::abs(own - other));
    }
  }
  double more = 0.0;
  EXPECT_FALSE(!theirs || theirs >> more) << file << ": another number of values";
  std::cout << fs::path(file).filename().string() << ": " << difference << " of " << largest
            << '\n';
  return largest > 0.0 ? difference / largest : difference;
}

// Whether the npm package of MuJoCo 3 can be called.
bool has_mujoco3() {
  return testing::output_of(
             "node -e \"import(process.env.BREAKWATER_MUJOCO3 ?? '@mujoco/mujoco')"
             ".then(() => console.log('there'), () => {})\" 2>/dev/null; true") == "there\n";
}

constexpr const char* kNoMujoco3 =
    "no node, or no npm package @mujoco/mujoco (BREAKWATER_MUJOCO3 names its mujoco.js)";

TEST_F(MjcfConversion, HasTheForcesOfMuJoCo3) {
  if (!has_mujoco3()) GTEST_SKIP() << kNoMujoco3;
  const std::string position = R"(<actuator><position joint="a" kp="10" )";
  const std::vector<std::pair<std::string, std::string>> files = {
      {"kv", arm("", position + R"(kv="2" forcerange="-1 1"/></actuator>)")},
      {"ratio", arm("", position + R"(dampratio="0.7" gear="3"/></actuator>)")},
      {"class", arm("", R"(<default><position kp="20" dampratio="1" inheritrange="0.9"/></default>
<actuator><position joint="a"/></actuator>)",
                    R"(range="-0.3 0.4")")},
      {"filter", arm("", position + R"(timeconst="0.1" kv="1"/></actuator>)")},
      {"integrated", arm("", R"(<actuator><intvelocity joint="a" kp="10" kv="2" actrange="-1 1"/>
</actuator>)")},
      {"limit", arm("", R"(<actuator><motor joint="a" gear="-20"/></actuator>)",
                    R"(actuatorfrcrange="-4 6")")},
      {"connect", arm("", R"(<equality><connect site1="mount" site2="tip"/></equality>)")},
      {"world", arm(R"(<site name="here" pos="1 2 3"/>)",
                    R"(<equality><connect site1="here" site2="tip"/></equality>)")},
      {"gravity", R"(<mujoco><worldbody><body gravcomp="0.5"><joint axis="0 1 0"/>
<geom size="0.1" pos="1 0 0"/><body pos="1 0 1" gravcomp="1" user="4"><joint axis="1 1 0"/>
<geom size="0.2" pos="1 0 0"/></body></body></worldbody></mujoco>)"},
      {"slack", R"(<mujoco><worldbody><site name="s" pos="1 0 1"/><body><joint axis="0 1 0"/>
<geom size="0.1" pos="1 0 0"/><site name="t" pos="1 0 0"/></body></worldbody><tendon>
<spatial springlength="0.7 0.9" stiffness="100"><site site="s"/><site site="t"/></spatial></tendon>
</mujoco>)"},
      {"euler", R"(<mujoco><compiler eulerseq="xYz"/><worldbody><frame euler="10 20 30" pos="1 2 3">
<body axisangle="1 2 3 40"><joint axis="0 1 0"/><geom size="0.1" fromto="1 2 3 4 5 7"
type="capsule"/><frame xyaxes="1 1 0 0 1 1"><body name="b" zaxis="0 1 2"><joint axis="1 2 3" pos="1 1 1"/>
<geom type="box" size="1 2 3" pos="1 2 0" euler="50 60 70"/></body></frame></body></frame></worldbody>
</mujoco>)"},
      {"copies", R"(<mujoco><default><default class="c"><joint damping="2"/></default></default>
<worldbody><replicate count="3" offset="1 2 3" euler="10 20 30"><frame pos="1 0 0" childclass="c">
<body name="b"><joint name="j" axis="0 1 0"/><geom type="box" size="1 2 3" pos="1 2 0"/>
<replicate count="2" euler="0 0 40" sep="_"><body name="d"><joint name="e" axis="1 0 0"/>
<geom type="box" size="1 2 1" pos="1 0 0"/></body></replicate></body></frame></replicate></worldbody>
<tendon><fixed name="f"><joint joint="j" coef="1"/><joint joint="e" coef="2"/></fixed></tendon>
<actuator><motor joint="j" name="first"/><position tendon="f" kp="100" kv="3"/></actuator></mujoco>)"},
  };
  for (const auto& [name, text] : files) {
    // The engine's constraints between sites agree at rest alone.
    const double speed = text.find("site1=") != std::string::npos ? 0.0 : 1.0;
    EXPECT_LE(difference_to_mujoco3(write(name + ".xml", text), folder_, speed), 1e-6) << name;
  }
}

// The public files and what becomes of them.
TEST_F(MjcfConversion, LoadsPublicFiles) {
  const fs::path robots = testing::source_file("../shared/robots");
  if (!fs::is_directory(robots)) GTEST_SKIP() << robots << ": no public model files here";
  const std::map<std::string, std::string> refused = {
      {"flag.xml", ":33: <flexcomp>: MuJoCo 2.2 does not have it"},
      {"pid.xml", ":10: <extension>: MuJoCo 2.2 does not have it"},
      {"treadmill.xml", "there is no file "}};
  const bool has_oracle = has_mujoco3();
  int loaded = 0;
  for (const auto& entry : fs::directory_iterator(robots)) {
    if (entry.path().extension() != ".xml") continue;
    const std::string file = entry.path().string();
    const auto reason = refused.find(entry.path().filename().string());
    try {
      Model::load(file);
      ++loaded;
      EXPECT_EQ(reason, refused.end()) << file;
      EXPECT_LE(conversion_warnings(file).size(), 1U);
      if (has_oracle) {
        // leaves.xml differs by 1.3 % (ellipsoids in air): the known gap is printed, not bounded.
        const bool is_known_gap = file.ends_with("leaves.xml");
        const double difference = difference_to_mujoco3(file, folder_);
        EXPECT_TRUE(is_known_gap || difference <= 1e-6) << file;
      }
    } catch (const std::invalid_argument& error) {
      ASSERT_NE(reason, refused.end()) << error.what();
      EXPECT_NE(std::string(error.what()).find(reason->second), std::string::npos) << error.what();
    }
  }
  EXPECT_GE(loaded, 14);
  if (!has_oracle) GTEST_SKIP() << kNoMujoco3;
}

// The files of a model: exactly those that the engine opens.

class MjcfFiles : public ::testing::Test {
 protected:
  void SetUp() override {
    for (const char* folder : {"parts", "shapes/deep", "colours"}) {
      fs::create_directories(folder_ / folder);
    }
    write("robot.xml", R"(<mujoco>
  <compiler meshdir="shapes" texturedir="colours"/>
  <include file="parts/assets.xml"/>
  <worldbody>
    <body><freejoint/><geom type="mesh" mesh="hull"/><include file="parts/arm.xml"/></body>
  </worldbody>
</mujoco>)");
    write("parts/assets.xml", R"(<mujoco>
  <asset>
    <mesh name="hull" file="deep/hull.stl"/>
    <texture name="skin" type="2d" file="skin.png"/>
  </asset>
  <include file="parts/option.xml"/>
</mujoco>)");
    write("parts/option.xml", R"(<mujoco><option gravity="0 0 0"/></mujoco>)");
    write("parts/arm.xml", R"(<mujoco><geom type="sphere" size="0.1"/></mujoco>)");
    write("unused.xml", "<mujoco/>");
    write_tetrahedron("shapes/deep/hull.stl");
    fs::copy(testing::source_file("docs/pictures/impact.png"), folder_ / "colours/skin.png");
  }

  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
  }

  // A binary STL.
  void write_tetrahedron(const std::string& name) const {
    const float corners[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    const int faces[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
    std::ofstream stream(folder_ / name, std::ios::binary);
    stream << std::string(80, ' ');
    const std::uint32_t count = 4;
    stream.write(reinterpret_cast<const char*>(&count), sizeof(count));
    for (const auto& face : faces) {
      stream << std::string(12, '\0');  // the normal, which is not used
      for (const int corner : face) {
        stream.write(reinterpret_cast<const char*>(corners[corner]), sizeof(corners[corner]));
      }
      stream << std::string(2, '\0');
    }
  }

  std::set<std::string> found() const {
    std::set<std::string> names;
    for (const fs::path& file : mjcf_files(folder_ / "robot.xml")) {
      names.insert(file.lexically_relative(folder_).string());
    }
    return names;
  }

  const testing::TemporaryPath folder_{"mjcf_files"};
};

TEST_F(MjcfFiles, AreExactlyTheFilesThatTheEngineNeeds) {
  const std::string model = (folder_ / "robot.xml").string();
  ASSERT_NO_THROW(Model::load(model));
  EXPECT_EQ(found(), std::set<std::string>({"robot.xml", "parts/assets.xml", "parts/arm.xml",
                                            "parts/option.xml", "shapes/deep/hull.stl",
                                            "colours/skin.png"}));
  EXPECT_EQ(mjcf_files(model).front(), fs::path(model));
  const std::set<std::string> needed = found();
  for (const auto& entry : fs::recursive_directory_iterator(folder_)) {
    if (!entry.is_regular_file()) continue;
    const fs::path aside = folder_.string() + ".aside";
    fs::rename(entry.path(), aside);
    const std::string name = entry.path().lexically_relative(folder_).string();
    if (needed.contains(name)) {
      EXPECT_REFUSED(Model::load(model)) << name;
    } else {
      EXPECT_NO_THROW(Model::load(model)) << name;
    }
    fs::rename(aside, entry.path());
  }
}

TEST_F(MjcfFiles, FoldersAreStrippedIfTheModelDemandsIt) {
  write("robot.xml", R"(<mujoco>
  <compiler meshdir="shapes/deep" strippath="true"/>
  <asset><mesh name="hull" file="C/elsewhere/hull.stl"/></asset>
  <worldbody><geom type="mesh" mesh="hull"/></worldbody>
</mujoco>)");
  ASSERT_NO_THROW(Model::load((folder_ / "robot.xml").string()));
  EXPECT_EQ(found(), std::set<std::string>({"robot.xml", "shapes/deep/hull.stl"}));
}

TEST_F(MjcfFiles, AnotherFileHasOnlyItself) {
  for (const char* text : {"", "<mujoco>", "nothing", "<mujoco><include/></mujoco>",
                           R"(<mujoco><include file="robot.xml"/></mujoco>)",
                           R"(<mujoco><include file="nowhere.xml"/></mujoco>)"}) {
    write("robot.xml", text);
    EXPECT_EQ(found(), std::set<std::string>({"robot.xml"})) << text;
  }
  fs::remove(folder_ / "robot.xml");
  EXPECT_EQ(found(), std::set<std::string>());
}

}  // namespace breakwater::mjcf_conversion_test
