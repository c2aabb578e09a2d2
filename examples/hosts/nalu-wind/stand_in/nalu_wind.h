// A stand-in for what SparFSI needs of Nalu-Wind, STK and yaml-cpp, for tests: the same names, as Nalu-Wind has them at
// a40e39cc, over a mesh of lists that the driver fills. Each header that the sources in ../nalu include is, in the
// tests, one that includes this. Written anew: no line of theirs is here.
#ifndef NALU_WIND_STAND_IN_H
#define NALU_WIND_STAND_IN_H

#include <array>
#include <functional>
#include <map>
#include <memory>
#include <mpi.h>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace YAML {
// A map of names to texts; lists stand between brackets.
class Node {
  public:
    Node() = default;
    explicit Node(std::map<std::string, std::string> all) : m_all(std::move(all)) {
    }
    Node operator[](const std::string &key) const {
        Node found;
        const auto it = m_all.find(key);
        if (it != m_all.end()) {
            found.m_text = it->second;
            found.m_there = true;
        }
        return found;
    }
    explicit operator bool() const {
        return m_there;
    }
    template <typename T> T as() const {
        T value{};
        read(m_text, value);
        return value;
    }

  private:
    static void read(const std::string &text, std::string &value) {
        value = text;
    }
    template <typename T> static void read(const std::string &text, T &value) {
        std::istringstream(text) >> value;
    }
    template <typename T> static void read(const std::string &text, std::vector<T> &values) {
        std::string inner = text.substr(1, text.size() - 2), item;
        std::istringstream all(inner);
        while (std::getline(all, item, ',')) {
            T value{};
            read(item, value);
            values.push_back(value);
        }
    }
    std::map<std::string, std::string> m_all;
    std::string m_text;
    bool m_there{false};
};
} // namespace YAML

namespace stk {
struct topology {
    enum rank_t { NODE_RANK, EDGE_RANK, FACE_RANK };
};

namespace mesh {
enum FieldState { StateNP1, StateN, StateNM1 };

struct Entity {
    size_t id{0};
};

struct Part {
    std::string name;
    std::set<size_t> members[3]; // by rank of the entity
};
using PartVector = std::vector<Part *>;

class Selector {
  public:
    using Rule = std::function<bool(topology::rank_t, size_t)>;
    Selector(const Part &part) // NOLINT: parts become selectors by themselves
        : m_rule([&part](topology::rank_t rank, size_t id) { return part.members[rank].count(id) > 0; }) {
    }
    explicit Selector(Rule rule) : m_rule(std::move(rule)) {
    }
    bool operator()(topology::rank_t rank, size_t id) const {
        return m_rule(rank, id);
    }
    friend Selector operator|(const Selector &a, const Selector &b) {
        return Selector(Rule([a, b](topology::rank_t r, size_t i) { return a(r, i) || b(r, i); }));
    }
    friend Selector operator&(const Selector &a, const Selector &b) {
        return Selector(Rule([a, b](topology::rank_t r, size_t i) { return a(r, i) && b(r, i); }));
    }

  private:
    Rule m_rule;
};
inline Selector operator|(const Part &a, const Part &b) {
    return Selector(a) | Selector(b);
}
inline Selector operator&(const Part &a, const Selector &b) {
    return Selector(a) & b;
}

template <typename T> class Field {
  public:
    std::vector<T> values;
    size_t length{0};
    Field *older[2] = {nullptr, nullptr};
    void sync_to_host() const {
    }
    void sync_to_device() const {
    }
    void modify_on_host() const {
    }
    Field &field_of_state(FieldState state) {
        return state == StateNP1 ? *this : *older[state - 1];
    }
};
template <typename T> T *field_data(const Field<T> &field, Entity entity) {
    return const_cast<T *>(field.values.data()) + field.length * entity.id;
}

class Bucket {
  public:
    std::vector<Entity> all;
    size_t size() const {
        return all.size();
    }
    Entity operator[](size_t i) const {
        return all[i];
    }
    int topology() const {
        return 4;
    } // quadrilaterals
};

class MetaData {
  public:
    std::map<std::string, Part> parts;
    std::map<std::string, Field<double>> fields;
    Part owned, shared;
    Part *get_part(const std::string &name) {
        const auto it = parts.find(name);
        return it == parts.end() ? nullptr : &it->second;
    }
    template <typename T> Field<T> *get_field(topology::rank_t, const std::string &name) {
        return &fields.at(name);
    }
    topology::rank_t side_rank() const {
        return topology::FACE_RANK;
    }
    const Part &locally_owned_part() const {
        return owned;
    }
    const Part &globally_shared_part() const {
        return shared;
    }
};

class BulkData {
  public:
    MetaData meta;
    size_t count[3] = {0, 0, 0};
    std::vector<std::array<Entity, 4>> faces;
    MetaData &mesh_meta_data() {
        return meta;
    }
    MPI_Comm parallel() const {
        return MPI_COMM_WORLD;
    }
    int parallel_rank() const {
        int rank;
        MPI_Comm_rank(MPI_COMM_WORLD, &rank);
        return rank;
    }
    int parallel_size() const {
        int size;
        MPI_Comm_size(MPI_COMM_WORLD, &size);
        return size;
    }
    const Entity *begin_nodes(Entity face) const {
        return faces[face.id].data();
    }
    // buckets of five, so that there are some
    std::vector<const Bucket *> get_buckets(topology::rank_t rank, const Selector &selector) {
        std::vector<const Bucket *> found;
        for (size_t id = 0; id < count[rank]; ++id) {
            if (!selector(rank, id)) {
                continue;
            }
            if (found.empty() || found.back()->size() == 5) {
                m_buckets.push_back(std::make_unique<Bucket>());
                found.push_back(m_buckets.back().get());
            }
            m_buckets.back()->all.push_back(Entity{id});
        }
        return found;
    }

  private:
    std::vector<std::unique_ptr<Bucket>> m_buckets;
};
} // namespace mesh
} // namespace stk

namespace sierra {
namespace nalu {
using VectorFieldType = stk::mesh::Field<double>;

struct HostShmem {};
template <typename T, typename Space> class SharedMemView;
template <typename Space> class SharedMemView<double **, Space> {
  public:
    SharedMemView(double *data, int, int columns) : m_data(data), m_columns(columns) {
    }
    double &operator()(int i, int k) const {
        return m_data[i * m_columns + k];
    }

  private:
    double *m_data;
    int m_columns;
};

// A quadrilateral with an integration point in each quarter.
class MasterElement {
  public:
    int nodesPerElement_{4};
    int num_integration_points() const {
        return 4;
    }
    template <typename = void> void shape_fcn(SharedMemView<double **, HostShmem> &shape) const {
        const double at[2] = {0.25, 0.75};
        for (int ip = 0; ip < 4; ++ip) {
            const double s = at[ip == 1 || ip == 2], t = at[ip > 1];
            const double own[4] = {(1 - s) * (1 - t), s * (1 - t), s * t, (1 - s) * t};
            for (int n = 0; n < 4; ++n) {
                shape(ip, n) = own[n];
            }
        }
    }
};
struct MasterElementRepo {
    static MasterElement *get_surface_master_element_on_host(int) {
        static MasterElement quad;
        return &quad;
    }
};

// Forces of the walls, by the driver's flow.
class CalcLoads {
  public:
    explicit CalcLoads(stk::mesh::PartVector &parts) : m_parts(parts) {
    }
    void setup(std::shared_ptr<stk::mesh::BulkData> bulk) {
        m_bulk = std::move(bulk);
    }
    void initialize() {
    }
    void execute() {
        flow(*m_bulk, m_parts);
    }
    static std::function<void(stk::mesh::BulkData &, const stk::mesh::PartVector &)> flow;

  private:
    stk::mesh::PartVector &m_parts;
    std::shared_ptr<stk::mesh::BulkData> m_bulk;
};

inline void compute_edge_scalar_divergence(stk::mesh::BulkData &, const stk::mesh::PartVector &,
                                           const stk::mesh::PartVector &, stk::mesh::Field<double> *,
                                           stk::mesh::Field<double> *) {
}
} // namespace nalu
} // namespace sierra

#endif
