// Runs a behaviour tree with replaced nodes: `runner TREE.xml STEPS < outcomes`.
//
// A line of input is the outcome of one action: its duration (s), whether it reads a value, the
// value, whether the value is abnormal, and whether the action fails; a failure with an
// even value is unreadable, one with an odd value unreachable. The outcomes are used in turn. A line of output is the start of an action: the time
// and the node's name. The last line is the blackboard entry `outcome`, or 0.
//
//   c++ -std=c++17 -O1 btcpp_runner.cpp -lbehaviortree_cpp -o runner

#include <cstdlib>
#include <iostream>
#include <vector>

#include "behaviortree_cpp/bt_factory.h"

namespace
{
struct Outcome
{
  double duration;
  bool reads;
  double value;
  bool abnormal;
  bool fails;
};

std::vector<Outcome> outcomes;
std::size_t drawn = 0;
int steps = 0;
double now = 0.0;

const Outcome& act(const std::string& name)
{
  if(static_cast<int>(drawn) == steps)
  {
    std::cout << 0 << std::endl;
    std::exit(0);
  }
  std::cout << now << " " << name << "\n";
  const Outcome& outcome = outcomes[drawn++ % outcomes.size()];
  now += outcome.duration;
  return outcome;
}

BT::PortsList way_ports()
{
  return { BT::InputPort<double>("x"), BT::InputPort<double>("y"), BT::InputPort<double>("z"),
           BT::InputPort<double>("yaw"), BT::InputPort<double>("velocity"),
           BT::InputPort<double>("not_before"), BT::InputPort<std::string>("joint_names"),
           BT::InputPort<std::string>("joint_positions"),
           BT::InputPort<std::string>("joint_velocities"),
           BT::InputPort<std::string>("joint_efforts") };
}

class Clock : public BT::SyncActionNode
{
public:
  using SyncActionNode::SyncActionNode;
  static BT::PortsList providedPorts()
  {
    return { BT::OutputPort<double>("now") };
  }
  BT::NodeStatus tick() override
  {
    setOutput("now", now);
    return BT::NodeStatus::SUCCESS;
  }
};

class Measure : public BT::SyncActionNode
{
public:
  using SyncActionNode::SyncActionNode;
  static BT::PortsList providedPorts()
  {
    BT::PortsList ports = way_ports();
    ports.insert({ BT::InputPort<std::string>("object_id"), BT::InputPort<double>("reading_limit"),
                   BT::OutputPort<double>("value"), BT::OutputPort<double>("known"),
                   BT::OutputPort<double>("abnormal"), BT::OutputPort<double>("unreadable"),
                   BT::OutputPort<double>("unreachable"), BT::OutputPort<double>("time") });
    return ports;
  }
  BT::NodeStatus tick() override
  {
    const Outcome& outcome = act(name());
    const bool known = outcome.reads && !outcome.fails;
    setOutput("value", known ? outcome.value : 0.0);
    setOutput("known", known ? 1.0 : 0.0);
    setOutput("abnormal", known && outcome.abnormal ? 1.0 : 0.0);
    const bool odd = static_cast<long>(outcome.value) % 2 == 1;
    setOutput("unreadable", outcome.fails && outcome.reads && !odd ? 1.0 : 0.0);
    setOutput("unreachable", outcome.fails && outcome.reads && odd ? 1.0 : 0.0);
    setOutput("time", now);
    return outcome.fails ? BT::NodeStatus::FAILURE : BT::NodeStatus::SUCCESS;
  }
};

class DriveTo : public BT::SyncActionNode
{
public:
  using SyncActionNode::SyncActionNode;
  static BT::PortsList providedPorts()
  {
    return way_ports();
  }
  BT::NodeStatus tick() override
  {
    return act(name()).fails ? BT::NodeStatus::FAILURE : BT::NodeStatus::SUCCESS;
  }
};
}  // namespace

int main(int argc, char** argv)
{
  if(argc != 3)
  {
    std::cerr << "usage: runner TREE.xml STEPS < outcomes\n";
    return 2;
  }
  steps = std::atoi(argv[2]);
  Outcome outcome{};
  while(std::cin >> outcome.duration >> outcome.reads >> outcome.value >> outcome.abnormal >>
        outcome.fails)
  {
    outcomes.push_back(outcome);
  }
  BT::BehaviorTreeFactory factory;
  factory.registerNodeType<Clock>("Clock");
  factory.registerNodeType<Measure>("Measure");
  factory.registerNodeType<DriveTo>("DriveTo");
  auto tree = factory.createTreeFromFile(argv[1]);
  tree.tickWhileRunning();
  std::cout << tree.rootBlackboard()->get<double>("outcome") << std::endl;
  return 0;
}
