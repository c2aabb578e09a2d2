// A stand-in for what SparFSI needs of STK and of Nalu-Wind, for tests: the same names, as Nalu-Wind has them at
// a40e39cc, over a mesh of lists that the driver fills. As there, fields are declared before the mesh is read and have
// values after it, a field that is missing is a null pointer, and buckets come in another order after a change of the
// mesh. Written anew: no line of theirs is here.
#ifndef STK_NALU_STAND_IN_H
#define STK_NALU_STAND_IN_H

#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <memory>
#include <mpi.h>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

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
inline Selector selectUnion(const PartVector &parts) {
    return Selector(Selector::Rule([parts](topology::rank_t r, size_t i) {
        return std::any_of(parts.begin(), parts.end(), [r, i](const Part *p) { return p->members[r].count(i) > 0; });
    }));
}

class FieldBase {};
template <typename T> class Field : public FieldBase {
  public:
    std::vector<T> values; // none before the mesh is read
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
    const size_t at = field.length * entity.id;
    return at < field.values.size() ? const_cast<T *>(field.values.data()) + at : nullptr;
}
template <typename T> void put_field_on_mesh(Field<T> &field, const Part &, unsigned length, const T *) {
    field.length = length;
}
template <typename T> void put_field_on_mesh(Field<T> &field, const Part &, const T *) {
    field.length = 1;
}
inline void put_field_on_mesh(Field<double> &field, const Part &, unsigned length, std::nullptr_t) {
    field.length = length;
}
inline void put_field_on_mesh(Field<double> &field, const Part &, std::nullptr_t) {
    field.length = 1;
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
    std::map<std::string, topology::rank_t> rank;
    Part owned, shared, all;
    Part *get_part(const std::string &name) {
        const auto it = parts.find(name);
        return it == parts.end() ? nullptr : &it->second;
    }
    template <typename T> Field<T> *get_field(topology::rank_t, const std::string &name) {
        const auto it = fields.find(name);
        return it == fields.end() ? nullptr : &it->second;
    }
    template <typename T> Field<T> &declare_field(topology::rank_t where, const std::string &name) {
        rank[name] = where;
        return fields[name];
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
    const Part &universal_part() const {
        return all;
    }
};

class BulkData {
  public:
    explicit BulkData(MPI_Comm comm) : m_comm(comm) {
    }
    MetaData meta;
    size_t count[3] = {0, 0, 0};
    std::vector<std::array<Entity, 4>> faces;
    std::vector<double> areas; // of the faces
    bool reversed{false};      // order of buckets and of what is in them
    size_t lost{SIZE_MAX};     // a face that has left this rank
    MetaData &mesh_meta_data() {
        return meta;
    }
    MPI_Comm parallel() const {
        return m_comm;
    }
    int parallel_rank() const {
        int rank;
        MPI_Comm_rank(m_comm, &rank);
        return rank;
    }
    int parallel_size() const {
        int size;
        MPI_Comm_size(m_comm, &size);
        return size;
    }
    bool is_valid(Entity entity) const {
        return entity.id != lost;
    }
    const Entity *begin_nodes(Entity face) const {
        return faces[face.id].data();
    }
    // buckets of five, so that there are some
    std::vector<const Bucket *> get_buckets(topology::rank_t rank, const Selector &selector) {
        std::vector<const Bucket *> found;
        for (size_t i = 0; i < count[rank]; ++i) {
            const size_t id = reversed ? count[rank] - 1 - i : i;
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
    MPI_Comm m_comm;
    std::vector<std::unique_ptr<Bucket>> m_buckets;
};
} // namespace mesh
} // namespace stk

namespace sierra {
namespace nalu {
using VectorFieldType = stk::mesh::Field<double>;
using GenericFieldType = stk::mesh::Field<double>;

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

// Forces of the walls, by the driver's flow; none before the initial condition of the flow, as there is no pressure.
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
        if (flow) {
            flow(*m_bulk, m_parts);
        }
    }
    static std::function<void(stk::mesh::BulkData &, const stk::mesh::PartVector &)> flow;

  private:
    stk::mesh::PartVector m_parts;
    std::shared_ptr<stk::mesh::BulkData> m_bulk;
};

inline void compute_edge_scalar_divergence(stk::mesh::BulkData &, stk::mesh::PartVector &, stk::mesh::PartVector &,
                                           GenericFieldType *face, stk::mesh::FieldBase *divergence) {
    if (face == nullptr || divergence == nullptr) {
        throw std::runtime_error("divergence of the mesh velocity: a field is missing");
    }
}
} // namespace nalu
} // namespace sierra

#endif
