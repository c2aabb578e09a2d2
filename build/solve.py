import io,contextlib
with contextlib.redirect_stdout(io.StringIO()): exec(open('proto.py').read().split("print('--- cant y')")[0])
z=[1.5+float(r['span_m']) for r in rows]; sw=[float(r['sweep_ac_m']) for r in rows]; cv=[float(r['curve_ac_m']) for r in rows]
N=19
for name,L in (('3d',[math.dist((z[i],sw[i],cv[i]),(z[i-1],sw[i-1],cv[i-1])) for i in range(1,N)]),('z',[z[i]-z[i-1] for i in range(1,N)])):
    a=[0]*N;b=[0]*N;c=[0]*N
    for i in range(N-1):
        b[i]+=L[i]/3;b[i+1]+=L[i]/3;c[i]+=L[i]/6;a[i+1]+=L[i]/6
    d=ref[:]
    for i in range(1,N):
        m=a[i]/b[i-1]; b[i]-=m*c[i-1]; d[i]-=m*d[i-1]
    f=[0]*N; f[-1]=d[-1]/b[-1]
    for i in range(N-2,-1,-1): f[i]=(d[i]-c[i]*f[i+1])/b[i]
    print(name,' '.join('%.1f'%x for x in f))
b=io.StringIO()
with contextlib.redirect_stdout(b): run(8,9.16,lastmode='fix',firstmode='fix',cant='y',verbose=1)
print('ours',' '.join(l.split('fx=')[1].split()[0] for l in b.getvalue().splitlines()))
