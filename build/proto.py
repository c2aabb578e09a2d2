import csv,math,sys
D='/work/shared/reference/nrel5mw/'
rows=list(csv.DictReader(open(D+'blade_aero.csv')))
pol={}
for n in set(r['polar'] for r in rows):
    t=[tuple(float(x) for x in (q['alpha_deg'],q['cl'],q['cd'],q['cm'])) for q in csv.DictReader(open(D+'polars/'+n+'.csv'))]
    pol[n]=t
def ev(t,a):
    a=math.degrees(a); a=(a+180)%360-180
    import bisect
    i=max(1,min(len(t)-1,bisect.bisect_right([q[0] for q in t],a)))
    w=(a-t[i-1][0])/(t[i][0]-t[i-1][0])
    return [t[i-1][k]+(t[i][k]-t[i-1][k])*w for k in (1,2,3)]
def run(U,rpm,rad='xy',Rt=None,Rh=1.5,lastmode='solve',firstmode='solve',verbose=0,rloss='r',cant=0):
    B=3;rho=1.225;Om=rpm*2*math.pi/60
    z=[1.5+float(r['span_m']) for r in rows]; sw=[float(r['sweep_ac_m']) for r in rows]; cv=[float(r['curve_ac_m']) for r in rows]
    N=len(z)
    arc=[z[0]]
    for i in range(1,N): arc.append(arc[-1]+math.dist((z[i],sw[i],cv[i]),(z[i-1],sw[i-1],cv[i-1])))
    fx=[];fy=[];out=[]
    for i,r in enumerate(rows):
        rr=math.hypot(z[i],sw[i]) if rad=='xy' else z[i]
        rl={'r':rr,'arc':arc[i],'z':z[i]}[rloss]
        RT=Rt if Rt else {'r':math.hypot(z[-1],sw[-1]),'arc':arc[-1],'z':z[-1]}[rloss]
        c=float(r['chord_m']);th=math.radians(float(r['twist_deg']));P=pol[r['polar']]
        # velocity at swept point: Om x r ; component along blade root frame y(TE)= Om*z ; radial comp dropped
        Vx=U;Vy=Om*(rr if rad=='xy' else z[i])
        if cant=='y': Vy=Om*z[i]
        sig=B*c/(2*math.pi*rr)
        def ind(ph):
            cl,cd,cm=ev(P,ph-th)
            s,co=math.sin(ph),math.cos(ph)
            ft=B*max(0,RT-rl)/(2*rl*abs(s)); fh=B*max(0,rl-Rh)/(2*Rh*abs(s))
            F=(2/math.pi*math.acos(min(1,math.exp(-ft))))*(2/math.pi*math.acos(min(1,math.exp(-fh))))
            F=max(F,1e-4) if lastmode=='floor' else max(F,1e-12)
            cn=cl*co;ct=cl*s
            k=sig*cn/(4*F*s*s)
            if k<=2/3: oma=1/(1+k) if k!=-1 else 1e30
            else:
                g1=2*F*k-(10/9-F);g2=2*F*k-F*(4/3-F);g3=2*F*k-(25/9-2*F)
                a=(g1-math.sqrt(g2))/g3 if abs(g3)>1e-6 else 1-1/(2*math.sqrt(g2))
                oma=1-a
            R=Vy*s/oma-Vx*(co-sig*ct/(4*F*s))
            kp=sig*ct/(4*F*s*co)
            return R,1-oma,kp/(1-kp) if kp!=1 else 1e9,F
        a=ap=0;fixed=0
        if (i==N-1 and lastmode=='fix') or (i==0 and firstmode=='fix'): ph=0;a=1;ap=0;fixed=1
        elif (i==N-1 and lastmode=='zero') or (i==0 and firstmode=='zero'): ph=math.atan2(Vx,Vy);a=0;ap=0;fixed=1
        else:
            lo,hi=1e-9,math.pi/2
            if ind(lo)[0]*ind(hi)[0]>0:
                ph=math.atan2(Vx,Vy);fixed=2
            else:
                slo=ind(lo)[0]
                for _ in range(200):
                    m=.5*(lo+hi)
                    if ind(m)[0]*slo>0: lo=m
                    else: hi=m
                ph=.5*(lo+hi); _,a,ap,F=ind(ph)
        cl,cd,cm=ev(P,ph-th)
        W2=(Vx*(1-a))**2+(Vy*(1+ap))**2
        cn=cl*math.cos(ph)+cd*math.sin(ph);ct=cl*math.sin(ph)-cd*math.cos(ph)
        fx.append(.5*rho*W2*c*cn);fy.append(.5*rho*W2*c*ct)
        out.append((a,ap,math.degrees(ph),cl,fixed))
    L=[math.dist((z[i],sw[i],cv[i]),(z[i-1],sw[i-1],cv[i-1])) for i in range(1,N)]
    def lump(f,L=L):
        o=[0]*N
        for i in range(N-1):
            o[i]+=L[i]/6*(2*f[i]+f[i+1]); o[i+1]+=L[i]/6*(2*f[i+1]+f[i])
        return o
    FX=lump(fx);FY=lump(fy)
    T=3*sum(FX);Q=3*sum(FY[i]*z[i] for i in range(N))
    if verbose:
        for i in range(N): print('%2d a=%8.4f ap=%8.4f phi=%8.4f cl=%7.4f %d fx=%9.2f FX=%9.1f ref=%9.1f d=%6.1f'%(i,*out[i],fx[i],FX[i],ref[i],FX[i]-ref[i]))
    return T/1e3,Q/1e6,Q*Om/1e6
ref=[float(x) for x in '16.7 141.7 235.9 619.1 2592.4 4171.4 5077.0 6128.1 7502.2 8869.6 10490.2 11965.6 12986.4 14215.4 14063.3 11994.9 10138.5 5925.4 1265.9'.split()]
print('sum',sum(ref)*3/1e3)
def rel(x,y): return ' '.join('%.5f(%+.4f%%)'%(p,100*(p/q-1)) for p,q in zip(x,y))
R8=(385.20,1.97713,1.89652);R11=(744.28,4.28728,5.43245)
for kw in (dict(Rt=63.),dict(lastmode='fix',firstmode='fix'),dict(lastmode='fix',firstmode='fix',rad='z'),dict(lastmode='fix',firstmode='fix',rad='z',rloss='z'),dict(lastmode='fix',firstmode='fix',rad='xy',rloss='arc'),dict(lastmode='fix',firstmode='fix',rad='xy',cant='y'),dict(lastmode='fix',firstmode='fix',rad='z',rloss='arc'),dict(lastmode='zero',firstmode='zero')):
    print(kw);print('  8:',rel(run(8,9.16,**kw),R8));print(' 11:',rel(run(11.4,12.1,**kw),R11))
run(8,9.16,lastmode='fix',firstmode='fix',verbose=1)
run(8,9.16,Rt=63.,verbose=1)
print('--- cant y')
run(8,9.16,lastmode='fix',firstmode='fix',cant='y',verbose=1)
import copy
base=copy.deepcopy(rows)
for d in (1,.3,.1,.03,.01,.003,.001,1e-4,1e-5,1e-6):
    rows[:]=copy.deepcopy(base); rows[-1]['span_m']=str(61.5-d); rows[-1]['sweep_ac_m']='0'
    print(d); sys.stdout.flush()
    import io,contextlib
    b=io.StringIO()
    with contextlib.redirect_stdout(b): run(8,9.16,Rt=63.,verbose=1)
    print(b.getvalue().splitlines()[-1])
