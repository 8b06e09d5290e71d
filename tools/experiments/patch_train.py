# SPDX-License-Identifier: GPL-3.0-or-later
import sys,time; sys.path.insert(0,'.')
from patch_lib import *
import torch; torch.set_num_threads(1); torch.manual_seed(1)
M=8
def compress(y): return np.where(np.abs(y)>3,np.sign(y)*3*(1+np.log(np.maximum(np.abs(y),3)/3)),y)
FACE=np.array([[1,2,3],[0,3,2],[0,1,3],[0,2,1]])

def below(h):
    """share of a tetrahedron's volume where the linear h of the vertices (n,4) is negative, and the barycentric centroid (n,4)"""
    n=len(h); od=np.argsort(h,1); k=np.take_along_axis(h,od,1); c=(k<0).sum(1); v=np.zeros(n); b=np.full((n,4),.25)
    I=np.eye(4)
    def cut(a,d,K): # point on edge a-d where h=0, barycentric in sorted order
        t=K[:,a]/(K[:,a]-K[:,d]); return (1-t)[:,None]*I[a]+t[:,None]*I[d]
    q=c==4; v[q]=1
    q=c==1; K=k[q]; P=[cut(0,d,K) for d in (1,2,3)]
    v[q]=np.prod([K[:,0]/(K[:,0]-K[:,d]) for d in (1,2,3)],0); b[q]=(I[0]+P[0]+P[1]+P[2])/4
    q=c==3; K=k[q]; P=[cut(3,d,K) for d in (0,1,2)]
    w=np.prod([K[:,3]/(K[:,3]-K[:,d]) for d in (0,1,2)],0); m=(I[3]+P[0]+P[1]+P[2])/4
    v[q]=1-w; b[q]=(.25-w[:,None]*m)/np.maximum(1-w,1e-12)[:,None]
    q=c==2; K=k[q]; ac,ad,bc,bd=cut(0,2,K),cut(0,3,K),cut(1,2,K),cut(1,3,K); one=np.ones((len(K),1)); A,B=one*I[0],one*I[1]
    tot=0; mom=0
    for T in ((A,ac,ad,bd),(A,ac,bc,bd),(A,B,bc,bd)):
        w=np.abs(np.linalg.det(np.stack(T,1))); tot=tot+w; mom=mom+w[:,None]*sum(T)/4
    v[q]=tot; b[q]=mom/np.maximum(tot,1e-300)[:,None]
    out=np.empty_like(b); np.put_along_axis(out,od,b,1)
    return v,out
def samples(n,train=True):
    m,st=load(f'./patch_{n}.bin')
    # outer triangles of the contact mesh, with the body told by connectivity of facings: cells seen with one side of a facing
    oc,of=np.nonzero((m['outer'][:,None]>>np.arange(4))&1)
    # bodies: components through tets' vertices
    import scipy.sparse as sp, scipy.sparse.csgraph as cg
    c=m['cells']; e=sp.coo_matrix((np.ones(c.size),(np.repeat(c[:,0],4),c.ravel())),(m['P'],m['P']))
    _,comp=cg.connected_components(e,directed=False); body=comp[c[:,0]]
    tri=np.take_along_axis(c[oc],FACE[of],1); apex=c[oc,of]; tb=body[oc]
    out=[]
    for si,(t,x,r) in enumerate(st):
        s=state(m,x,r); V=r['v']
        T=x[tri]; nrm=np.cross(T[:,1]-T[:,0],T[:,2]-T[:,0]); a=x[apex]-T[:,0]
        flip=(nrm*a).sum(1)>0; Tt=T.copy(); Tt[flip,1],Tt[flip,2]=T[flip,2],T[flip,1]; nrm[flip]*=-1; nrm/=np.linalg.norm(nrm,axis=1)[:,None]; cen=Tt.mean(1)
        for t_ in (0,1):
            o=1-t_; key=r['f'].astype(np.int64)*m['C']+s['c'][:,t_]; u,inv=np.unique(key,return_inverse=True)
            first=np.zeros(len(u),int); first[inv]=np.arange(len(inv)); own=s['c'][first,t_]; ob=body[s['c'][first,o]]
            W=np.bincount(inv,V); xb=np.stack([np.bincount(inv,V*r['x'][:,q]) for q in range(3)],1)/W[:,None]
            Gm=np.stack([np.bincount(inv,V*s['G'][o][:,q]) for q in range(3)],1)/W[:,None]
            X=x[m['cells'][own]]; vol=np.abs(np.linalg.det(X[:,1:]-X[:,:1]))/6
            near=np.empty((len(u),M),int)
            for b in np.unique(ob):
                I=np.where(ob==b)[0]; J=np.where(tb==b)[0]
                d=((X[I].mean(1)[:,None]-cen[J][None])**2).sum(2); near[I]=J[np.argsort(d,1)[:,:M]]
            N=nrm[near]; Q=Tt[near]
            h=np.einsum('nvc,nc->nv',X-Q[:,0,0][:,None],N[:,0]); od=np.argsort(h,1)
            X=np.take_along_axis(X,od[:,:,None],1)
            E=X[:,1:]-X[:,:1]; inv_E=np.linalg.inv(E); y=np.einsum('ntvc,ncd->ntvd',Q-X[:,None,:1],inv_E)
            neg=np.linalg.det(E)<0; y[neg]=y[neg][:,:,[0,2,1]]
            l0=1-y.sum(3); start=np.argmin(l0,2); idx=(start[:,:,None]+np.arange(3))%3; y=np.take_along_axis(y,idx[:,:,:,None],2)
            lx=np.einsum('nc,ncd->nd',xb-X[:,0],inv_E)
            hh=np.einsum('nvtc,ntc->ntv',X[:,:,None]-Q[:,None,:,0],N); vv,bb=below(hh.reshape(-1,4)); vv=np.maximum(vv,1e-9).reshape(-1,M); bb=bb.reshape(-1,M,4)
            row=np.concatenate([compress(y).reshape(len(u),M,9),(np.log(vv+1e-4)/3)[:,:,None],bb],2)
            out.append((row.reshape(len(u),M*14).astype('f4'),vv.astype('f4'),(W/vol).astype('f4'),lx.astype('f4'),N.astype('f4'),Gm.astype('f4'),(s['k'][first]*s['S'][t_][first]*W).astype('f4'),np.full(len(u),si,'i4')))
    return [np.concatenate(z) for z in zip(*out)],len(st)
class Net(torch.nn.Module):
    def __init__(s,H=32,U=32):
        super().__init__(); L=torch.nn.Linear
        s.a=L(14,H); s.b=L(H,H); s.u=L(H,U); s.w=L(U,U); s.o=L(U,5); s.p=L(U,H,bias=False); s.q=L(U,H,bias=False)
    def forward(s,y,vv):
        n=len(y); Y=y.view(n,M,14); h=torch.relu(s.b(torch.relu(s.a(Y.reshape(n*M,14))))).view(n,M,-1)
        u=torch.relu(s.w(torch.relu(s.u(h.sum(1)/4)))); o=s.o(u)
        w=torch.softmax((h*s.p(u)[:,None]).sum(2)/6,1); g=torch.softmax((h*s.q(u)[:,None]).sum(2)/6,1)
        wv=w*vv; v0=wv.sum(1); l0=(wv[:,:,None]*Y[:,:,10:]).sum(1)/v0[:,None]
        e=(l0.clamp_min(1e-6).log()+torch.cat([0*o[:,:1],o[:,1:4]],1)); z=torch.softmax(e,1)[:,1:]
        return v0*torch.exp(torch.tanh(o[:,0])*1.5),z,g
def report(net,S,sel,name):
    y,vv,v,lx,N,G,f,si=[torch.tensor(q[sel]) for q in S]
    with torch.no_grad():
        V,z,w=[torch.cat(q) for q in zip(*[net(c,d) for c,d in zip(y.split(4096),vv.split(4096))])]
    g=(w[:,:,None]*N).sum(1)*-1
    vol=f/v
    Fh=vol[:,None]*V[:,None]*g; F=f[:,None]*G
    e=lambda a,b: float((a-b).abs().sum()/b.abs().sum())
    st=torch.unique(si); tot=torch.zeros(int(si.max())+1,3); tot.index_add_(0,si.long(),F); th=torch.zeros_like(tot); th.index_add_(0,si.long(),Fh)
    # of opposite terms the sum is not zero here: F of sides 0 and 1 point in opposite ways, so sum absolute per side is not told apart
    lam4=torch.cat([1-lx.sum(1,keepdim=True),lx],1); z4=torch.cat([1-z.sum(1,keepdim=True),z],1)
    print('   %-22s n %6d  V %.4f  xbar %.4f  moments %.4f  F rms %.4f  F direction only %.4f'%(name,len(v),float((f/v*(V-v).abs()).sum()/f.sum()),float((f[:,None]*(z4-lam4).abs()).sum()/f.sum()),float((vol[:,None]*(V[:,None]*z4-v[:,None]*lam4).abs()).sum()/f.sum()),float(((Fh-F)**2).sum().sqrt()/(F**2).sum().sqrt()),float(((f[:,None]*g-F)**2).sum().sqrt()/(F**2).sum().sqrt())),flush=True)
if __name__=='__main__':
    trainset=sys.argv[1].split(','); testset=sys.argv[2].split(','); steps=int(sys.argv[3])
    tr=[];te={}
    for n in trainset:
        S,ns=samples(n); sel=S[7]<.75*ns; te[n+' late']=(S,np.where(~sel)[0]); tr.append([q[sel] for q in S]); print(n,len(sel),flush=True)
    for n in testset:
        S,ns=samples(n); te[n]=(S,np.arange(len(S[0])))
    Y=[torch.tensor(np.concatenate(z)) for z in zip(*tr)]
    y,vv,v,lx,N,G,f,_=Y
    print('half-space of the nearest triangle alone:')
    class One(torch.nn.Module):
        def forward(s,y,vv):
            w=torch.zeros_like(vv); w[:,0]=1; return vv[:,0],y.view(len(y),M,14)[:,0,11:],w
    for k,(S,sel) in te.items(): report(One(),S,sel,k)
    net=Net(); opt=torch.optim.Adam(net.parameters(),1e-3); sch=torch.optim.lr_scheduler.OneCycleLR(opt,4e-3,total_steps=steps,pct_start=.1)
    t0=time.process_time()
    for s in range(steps):
        i=torch.randint(len(v),(512,)); V,z,w=net(y[i],vv[i]); g=-(w[:,:,None]*N[i]).sum(1); vi=v[i]
        hub=torch.nn.functional.huber_loss
        r=(vi/(vi+3e-3)); loss=(r*hub((V+1e-5).log(),(vi+1e-5).log(),delta=.03,reduction='none')/.03+2*r*torch.sqrt(((z-lx[i])**2).sum(1)+1e-6)+r*torch.sqrt(((g-G[i])**2).sum(1)+1e-6)).mean()
        opt.zero_grad(); loss.backward(); opt.step(); sch.step()
        if s%1000==999 or s==steps-1:
            print(s+1,'loss %.5f cpu %.0f'%(float(loss),time.process_time()-t0),flush=True)
            torch.save(net.state_dict(),'./patch2.pt')
            if s%4000==3999 or s==steps-1:
                for k,(S,sel) in te.items(): report(net,S,sel,k)
    P=[p.detach().numpy() for p in (net.a.weight.T,net.a.bias,net.b.weight.T,net.b.bias,net.u.weight.T,net.u.bias,net.w.weight.T,net.w.bias,net.o.weight.T,net.o.bias,net.p.weight.T,net.q.weight.T)]
    np.concatenate([q.ravel() for q in P]).astype('f4').tofile('./patch2.net'); print(sum(q.size for q in P),'parameters')
